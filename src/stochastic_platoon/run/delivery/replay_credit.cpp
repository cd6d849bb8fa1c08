#include "stochastic_platoon/run/delivery/replay_credit.hpp"

#include <algorithm>

namespace platoon {

namespace {
constexpr double kRetryGrowth = 1.5;
constexpr double kLongestRetry = 3.0;  // [s] limit of the growing first-step timeout
}  // namespace

ReplayCredit::ReplayCredit(const CreditLimits& limits)
    : limits_(limits), first_step_patience_(limits.first_step_timeout), patience_(limits.stall_timeout) {}

bool ReplayCredit::may_send() const {
  return sent_ - answered_ < (answered_in_attempt_ == 0 ? 1 : limits_.window);
}

void ReplayCredit::send(bool begins_batch, double now) {
  if (begins_batch || starts_.empty()) starts_.push_back(sent_);
  if (sent_ <= answered_) last_activity_ = now;  // idle until now: the wait for an answer begins here
  if (sent_ == 0 && repetitions_ == 0) last_progress_ = now;
  ++sent_;
}

// The two topics of a recording may hold different parts of an abandoned attempt: the first answer of a batch belongs
// to the batch's first message.
void ReplayCredit::answer(bool begins_batch, double now) {
  if (begins_batch && answered_in_attempt_ > 0 && starts_.size() > 1) {
    starts_.pop_front();
    answered_ = starts_.front();
  }
  ++answered_;
  ++answered_in_attempt_;
  flowed_ = true;
  last_activity_ = now;
  if (answered_ <= most_answered_) return;
  most_answered_ = answered_;
  progressed_ = true;
  last_progress_ = now;
  first_step_patience_ = limits_.first_step_timeout;
  patience_ = limits_.stall_timeout;
}

bool ReplayCredit::retry_if_stalled(double now) {
  if (sent_ <= answered_ || !may_begin()) return false;
  const bool unanswered = answered_in_attempt_ == 0;
  double& patience = unanswered ? first_step_patience_ : patience_;
  if (now - last_activity_ < patience) return false;
  patience *= kRetryGrowth;
  if (unanswered) patience = std::min(patience, std::max(limits_.first_step_timeout, kLongestRetry));
  begin_again(now);
  return true;
}

bool ReplayCredit::give_up(double now) {
  if (!progressed_ || !may_begin()) return false;
  begin_again(now);
  return true;
}

void ReplayCredit::begin_again(double now) {
  sent_ = answered_ = starts_.front();
  starts_.clear();
  answered_in_attempt_ = 0;
  progressed_ = false;
  ++repetitions_;
  last_activity_ = now;
}

}  // namespace platoon
