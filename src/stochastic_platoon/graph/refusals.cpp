#include "stochastic_platoon/graph/refusals.hpp"

#include <ros/console.h>
#include <ros/time.h>

namespace platoon {

void Refusals::count(Verdict verdict, const Turn& turn, std::size_t size) {
  ++counts_[static_cast<std::size_t>(verdict)];
  if (verdict == Verdict::stale || verdict == Verdict::missed_start || verdict == Verdict::in_turn) return;
  const double now = ros::SteadyTime::now().toSec();
  if (last_said_ >= 0.0 && now - last_said_ < 1.0) return;
  last_said_ = now;
  ROS_WARN_STREAM(topic_ << ": dropped a message that is " << to_string(verdict) << ": attempt "
                         << turn.attempt << ", realizations from " << turn.first_realization << ", step "
                         << turn.step << ", " << size << " positions (so far " << of(Verdict::out_of_turn)
                         << " out of turn, " << of(Verdict::wrong_size) << " of wrong size, "
                         << of(Verdict::not_finite) << " not finite)");
}

}  // namespace platoon
