#include "stochastic_platoon/math/statistics/time_statistics.hpp"

#include <algorithm>

namespace platoon {

namespace {
constexpr std::int64_t kBeforeAll = -2;
}

TimeStatistics::TimeStatistics(std::size_t followers, std::int64_t burn_in, std::vector<Moments> earlier,
                               std::vector<std::int64_t> distances, bool limited)
    : burn_in_(burn_in),
      distances_(std::move(distances)),
      limited_(limited),
      counts_from_(burn_in),
      earlier_(std::move(earlier)),
      followers_(followers),
      batches_(followers) {
  earlier_.resize(followers);
  for (std::size_t i = distances_.size(); i < followers; ++i) distances_.push_back(static_cast<std::int64_t>(i));
}

void TimeStatistics::restart() {
  earlier_ = moments();
  followers_.assign(followers_.size(), Follower{});
  if (leader_step_ != kNever) leader_step_ = kBeforeAll;
  departed_ = kNever;
  counts_from_ = burn_in_;
}

void TimeStatistics::saw_leader(std::int64_t step, bool by_model) {
  leader_step_ = step;
  if (!by_model) {
    if (departed_ == kNever || step >= counts_from_) {
      departed_ = step;
      counted_from_ = counts_from_;
    }
    counts_from_ = std::max(counts_from_, step + 1 + burn_in_);
  }
  for (std::size_t i = 1; i <= followers_.size(); ++i) count_due(i);
}

bool TimeStatistics::counts(std::size_t follower, std::int64_t step) const {
  if (followers_[follower - 1].is_held_back(step)) return false;
  if (departed_ == kNever) return step >= counts_from_;
  const std::int64_t hops = static_cast<std::int64_t>(follower) - 1;
  if (is_reached(follower, step)) return step >= counts_from_ + hops;
  return step >= counted_from_ + (counted_from_ > burn_in_ ? hops : 0);
}

// Whether the latest manoeuvre began early enough to affect the error.
bool TimeStatistics::is_reached(std::size_t follower, std::int64_t step) const {
  return departed_ != kNever && step >= departed_ + distances_[follower - 1];
}

// Whether a manoeuvre affects the error directly; the burn-in behind it is not included.
bool TimeStatistics::departs(std::size_t follower, std::int64_t step) const {
  const std::int64_t hops = static_cast<std::int64_t>(follower) - 1;
  return is_reached(follower, step) && step < counts_from_ - burn_in_ + hops;
}

void TimeStatistics::add(const ReducedSignals& signals) {
  const AtLimits& at = signals.at_limits;
  const bool at_limit = std::any_of(at.begin(), at.end(), [](std::uint64_t count) { return count > 0; });
  // With one realization the mean is the error itself.
  followers_.at(signals.follower - 1).early.emplace(signals.step, Error{signals.nodes.front().front().mean, at_limit});
  std::size_t i = signals.follower;
  while (count_due(i) && limited_ && i < followers_.size()) ++i;  // the next one may wait for it
}

// Whether an error was due.
bool TimeStatistics::count_due(std::size_t index) {
  bool any = false;
  while (count_next(index)) any = true;
  return any;
}

bool TimeStatistics::Follower::is_held_back(std::int64_t step) const {
  return std::any_of(held_back.begin(), held_back.end(),
                     [step](const Steps& of) { return of.from <= step && step < of.until; });
}

void TimeStatistics::Follower::hold_back(const Steps& added) {
  for (Steps& known : held_back) {
    if (added.from > known.until || added.until < known.from) continue;
    known = {std::min(known.from, added.from), std::max(known.until, added.until)};
    return;
  }
  held_back.push_back(added);
}

// Extends the steps in which limits hold the follower back: from those of the vehicle ahead, and by its own.
void TimeStatistics::hold_back(std::size_t index, std::int64_t step, bool at_limit) {
  constexpr std::int64_t kMoreThanUsual = 2, kShort = 10;  // [times], [steps]
  Follower& own = followers_[index - 1];
  own.held = at_limit ? own.held + 1 : 0;
  if (index > 1) {
    for (const Steps& of : followers_[index - 2].held_back) own.hold_back(of);
  }
  if (!is_reached(index, step) || counts(index, step)) {
    own.usual = std::max(own.usual, own.held);
  } else if (own.held > kMoreThanUsual * own.usual + kShort &&
             is_reached(index, step - own.held)) {  // not since before the manoeuvre
    own.hold_back({step, step + 1 + burn_in_});
  }
}

bool TimeStatistics::count_next(std::size_t index) {
  Follower& follower = followers_[index - 1];
  const auto next = follower.early.begin();
  if (next == follower.early.end() || next->first != follower.next_step) return false;
  const std::int64_t step = next->first;
  if (leader_step_ != kNever && step > leader_step_ + distances_[index - 1]) return false;
  if (limited_ && index > 1 && followers_[index - 2].next_step < step) return false;
  const Error error = next->second;
  if (limited_) hold_back(index, step, error.at_limit);
  if (counts(index, step)) {
    follower.last_counted = step;
    follower.moments.add(error.value);
    batches_[index - 1].add(error.value);
  } else if (!measured(index - 1) && !departs(index, step)) {
    follower.provisional.add(error.value);
  }
  follower.early.erase(next);
  ++follower.next_step;
  return true;
}

bool TimeStatistics::empty() const {
  return std::all_of(followers_.begin(), followers_.end(), [](const Follower& of) { return of.next_step == 0; }) &&
         std::all_of(earlier_.begin(), earlier_.end(), [](const Moments& moments) { return moments.count == 0; });
}

std::int64_t TimeStatistics::counted_from() const {
  const std::int64_t hops = departed_ == kNever ? 0 : static_cast<std::int64_t>(followers_.size()) - 1;
  std::int64_t from = counts_from_ + hops;
  for (const Follower& follower : followers_) {
    for (const Steps& of : follower.held_back) from = std::max(from, of.until);
  }
  return from;
}

std::vector<Moments> TimeStatistics::moments() const {
  std::vector<Moments> all;
  for (std::size_t i = 0; i < followers_.size(); ++i) all.push_back(merge(earlier_[i], followers_[i].moments));
  return all;
}

std::vector<Moments> TimeStatistics::provisional() const {
  std::vector<Moments> all(followers_.size());
  bool any = false;
  for (std::size_t i = 0; i < followers_.size(); ++i) {
    if (measured(i)) continue;
    all[i] = followers_[i].provisional.moments();
    any = any || all[i].count > 0;
  }
  return any ? all : std::vector<Moments>();
}

std::vector<IndependentShare> TimeStatistics::shares() const {
  std::vector<IndependentShare> all;
  for (const BatchMeans& batches : batches_) all.push_back(batches.share());
  return all;
}

}  // namespace platoon
