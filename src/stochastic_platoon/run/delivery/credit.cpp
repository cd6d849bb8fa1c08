#include "stochastic_platoon/run/delivery/credit.hpp"

#include <algorithm>
#include <limits>
#include <tuple>

namespace platoon {

namespace {
constexpr double kGrowth = 1.5;
constexpr double kLongestStart = 3.0;  // [s] limit of the growing first-step timeout, or 1.5 stall_timeout if longer
constexpr double kNoticePause = 0.1;   // [s] between repetitions by notices, at least
constexpr double kQuietPauses = 10.0;  // without a notice until the pause is the shortest again

}  // namespace

Credit::Credit(const BatchSchedule& schedule, const CreditLimits& limits, const std::vector<std::string>& receivers)
    : schedule_(schedule),
      limits_(limits),
      first_step_patience_(limits.first_step_timeout),
      patience_(limits.stall_timeout),
      notice_pause_(kNoticePause) {
  for (const std::string& name : receivers) receivers_[name] = Receiver{};
}

std::int64_t Credit::acknowledged() const {
  std::int64_t least = std::numeric_limits<std::int64_t>::max();
  for (const auto& entry : receivers_) {
    const Receiver& receiver = entry.second;
    least = std::min(least, receiver.in_attempt ? steps_covered(schedule_, start_, *receiver.latest) : 0);
  }
  return least;
}

bool Credit::all_reported() const {
  return std::all_of(receivers_.begin(), receivers_.end(), [](const auto& entry) { return entry.second.latest; });
}

bool Credit::complete() const {
  return all_reported() && std::all_of(receivers_.begin(), receivers_.end(), [this](const auto& entry) {
           return schedule_.is_complete(entry.second.latest->first_realization);
         });
}

bool Credit::acknowledge(const std::string& receiver, const Acknowledgement& report, double now,
                         std::uint64_t messages) {
  const auto found = receivers_.find(receiver);
  if (found == receivers_.end()) return false;
  Receiver& sender = found->second;
  const std::int64_t before = acknowledged();
  const bool of_this_attempt = attempt_ > 0 && report.attempt == attempt_;
  // Reports only grow; a smaller one comes from a restarted receiver.
  const auto extent = [](const Acknowledgement& of, const std::uint64_t& count) {
    return std::tie(of.attempt, of.first_realization, of.step, count);
  };
  const bool lost = attempt_ > 0 && sender.latest && extent(report, messages) < extent(*sender.latest, sender.messages);
  const bool through_a_batch = sender.latest && report.first_realization > sender.latest->first_realization;
  sender.latest = report;
  const bool more = of_this_attempt && messages > (sender.in_attempt ? sender.messages : 0);
  if (more && !may_publish()) progressed(now);
  sender.messages = messages;
  sender.in_attempt = of_this_attempt;
  if (lost && !complete() && may_begin()) begin_attempt(now);
  if (acknowledged() > before) {
    flowed_ = true;
    progressed(now);
    if (before == 0) {  // the first step has a timeout of its own
      flows_since_ = now;
      longest_wait_ = 0.0;
    }
    first_step_patience_ = limits_.first_step_timeout;
    if (through_a_batch || now - flows_since_ > patience_)
      patience_ = std::max(limits_.stall_timeout, kGrowth * longest_wait_);
    if (through_a_batch) notice_pause_ = kNoticePause;
  }
  return true;
}

// A wait beyond the timeout, while nothing may be repeated, counts as that of the timeout.
void Credit::progressed(double now) {
  longest_wait_ = std::max(longest_wait_, std::min(now - last_activity_, patience_));
  last_activity_ = now;
}

// Without a stall_timeout no attempt begins once steps have flowed, even if the leader joins a running platoon.
bool Credit::may_begin() const {
  if (limits_.stall_timeout > 0.0) return true;
  if (attempt_ > 0) return !flowed_;
  return std::all_of(receivers_.begin(), receivers_.end(),
                     [](const auto& entry) { return entry.second.latest->step <= kInitialStep; });
}

bool Credit::may_publish() const {
  const std::int64_t acknowledged_steps = acknowledged();
  const std::int64_t allowed = acknowledged_steps == 0 ? 1 : limits_.window;
  return !schedule_.is_complete(upcoming_.first_realization) && published_ - acknowledged_steps < allowed;
}

void Credit::begin_attempt(double now) {
  start_ = schedule_.realizations;
  for (auto& entry : receivers_) {
    attempt_ = std::max(attempt_, entry.second.latest->attempt);
    start_ = std::min(start_, entry.second.latest->first_realization);
    entry.second.in_attempt = false;
  }
  ++attempt_;
  upcoming_ = {attempt_, start_, kInitialStep};
  published_ = 0;
  last_activity_ = now;
}

std::optional<MessageId> Credit::next(double now) {
  if (!all_reported() || complete()) return std::nullopt;
  if (attempt_ == 0 && !may_begin()) return std::nullopt;
  if (attempt_ == 0) begin_attempt(now);
  if (!may_publish()) return std::nullopt;
  const MessageId id = upcoming_;
  if (published_ == acknowledged()) last_activity_ = now;  // idle until now: the wait for an answer begins here
  ++published_;
  if (schedule_.is_last_step(id.step)) {
    upcoming_ = {attempt_, schedule_.next(id.first_realization), kInitialStep};
  } else {
    ++upcoming_.step;
  }
  return id;
}

bool Credit::may_give_up(std::uint32_t attempt, double now) const {
  return attempt == attempt_ && attempt_ > 0 && acknowledged() > 0 && !complete() && may_begin() && now >= next_notice_;
}

bool Credit::give_up(std::uint32_t attempt, double now) {
  if (!may_give_up(attempt, now)) return false;
  if (schedule_.endless() && now - next_notice_ > kQuietPauses * notice_pause_) notice_pause_ = kNoticePause;
  next_notice_ = now + notice_pause_;
  notice_pause_ *= kGrowth;
  begin_attempt(now);
  return true;
}

bool Credit::retry_if_stalled(double now) {
  if (attempt_ == 0 || complete() || published_ == acknowledged()) return false;
  const bool unanswered = acknowledged() == 0;
  if (!may_begin()) return false;
  double& patience = unanswered ? first_step_patience_ : patience_;
  if (now - last_activity_ < patience) return false;
  patience *= kGrowth;
  // Limit the wait for nodes that are still starting.
  const double longest = std::max(kGrowth * limits_.stall_timeout, kLongestStart);
  if (unanswered) patience = std::min(patience, std::max(limits_.first_step_timeout, longest));
  begin_attempt(now);
  return true;
}

}  // namespace platoon
