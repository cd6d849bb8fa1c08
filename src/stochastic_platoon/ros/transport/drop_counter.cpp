#include "stochastic_platoon/ros/transport/drop_counter.hpp"

#include <ros/console.h>

#include "stochastic_platoon/ros/transport/transport.hpp"

namespace platoon {

std::uint64_t DropCounter::faults() const {
  return of(DropReason::out_of_turn) + of(DropReason::wrong_size) + of(DropReason::not_finite) +
         of(DropReason::foreign_run);
}

void DropCounter::count(DropReason drop, const MessageId& id, std::size_t size) {
  ++counts_[static_cast<std::size_t>(drop)];
  if (!external_.empty() && broken_clause(drop)) breach_ = drop;
  if (drop == DropReason::stale || drop == DropReason::missed_start || drop == DropReason::none) return;
  const double present = now();
  if (last_said_ && present - *last_said_ < 1.0) return;
  last_said_ = present;
  const std::optional<DropReason> breach = latest_breach();
  ROS_WARN_STREAM(
      topic_ << ": dropped a message that is " << to_string(drop) << ": attempt " << id.attempt
             << ", realizations from " << id.first_realization << ", step " << id.step << ", " << size
             << " positions (so far " << of(DropReason::out_of_turn) << " out of turn, " << of(DropReason::wrong_size)
             << " of wrong size, " << of(DropReason::not_finite) << " not finite, " << of(DropReason::foreign_run)
             << " of another run)"
             << (breach ? ". " + external_ + " is external: it violates " + named(*broken_clause(*breach)) : ""));
}

}  // namespace platoon
