#include "stochastic_platoon/ros/transport/message_counter.hpp"

#include <ros/console.h>

#include "stochastic_platoon/ros/transport/transport.hpp"

namespace platoon {

std::uint64_t MessageCounter::faults() const {
  return dropped(DropReason::out_of_turn) + dropped(DropReason::wrong_size) + dropped(DropReason::not_finite) +
         dropped(DropReason::foreign_run);
}

void MessageCounter::take(const MessageId& id) {
  step_ = id.step;
  attempt_ = id.attempt;
  ++taken_;
  breach_ = DropReason::none;
}

void MessageCounter::drop(DropReason reason, const MessageId& id, std::size_t size) {
  ++dropped_[static_cast<std::size_t>(reason)];
  if (!external_.empty() && broken_clause(reason)) breach_ = reason;
  if (reason == DropReason::stale || reason == DropReason::missed_start) return;
  const double present = now();
  if (last_logged_ && present - *last_logged_ < 1.0) return;
  last_logged_ = present;
  const std::optional<DropReason> breach = latest_breach();
  ROS_WARN_STREAM(
      topic_ << ": dropped a message that is " << to_string(reason) << ": attempt " << id.attempt
             << ", realizations from " << id.first_realization << ", step " << id.step << ", " << size
             << " positions (so far " << dropped(DropReason::out_of_turn) << " out of turn, "
             << dropped(DropReason::wrong_size) << " of wrong size, " << dropped(DropReason::not_finite)
             << " not finite, " << dropped(DropReason::foreign_run) << " of another run)"
             << (breach ? ". " + external_ + " is external: it violates " + named(*broken_clause(*breach)) : ""));
}

}  // namespace platoon
