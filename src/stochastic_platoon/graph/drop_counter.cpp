#include "stochastic_platoon/graph/drop_counter.hpp"

#include <ros/console.h>

#include "stochastic_platoon/graph/transport.hpp"

namespace platoon {

std::uint64_t DropCounter::faults() const {
  return of(DropReason::out_of_turn) + of(DropReason::wrong_size) + of(DropReason::not_finite) +
         of(DropReason::foreign_run);
}

void DropCounter::count(DropReason verdict, const MessageId& id, std::size_t size) {
  ++counts_[static_cast<std::size_t>(verdict)];
  if (!external_.empty() && broken_clause(verdict)) breach_ = verdict;
  if (verdict == DropReason::stale || verdict == DropReason::missed_start || verdict == DropReason::none) return;
  const double present = now();
  if (last_said_ && present - *last_said_ < 1.0) return;
  last_said_ = present;
  const std::optional<DropReason> breach = latest_breach();
  ROS_WARN_STREAM(
      topic_ << ": dropped a message that is " << to_string(verdict) << ": attempt " << id.attempt
             << ", realizations from " << id.first_realization << ", step " << id.step << ", " << size
             << " positions (so far " << of(DropReason::out_of_turn) << " out of turn, " << of(DropReason::wrong_size)
             << " of wrong size, " << of(DropReason::not_finite) << " not finite, " << of(DropReason::foreign_run)
             << " of another run)"
             << (breach ? ". " + external_ + " is external: it violates " + named(*broken_clause(*breach)) : ""));
}

}  // namespace platoon
