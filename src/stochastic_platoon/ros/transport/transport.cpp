#include "stochastic_platoon/ros/transport/transport.hpp"

#include <ros/time.h>

#include <mutex>

#include "stochastic_platoon/ros/transport/spin_lock.hpp"

namespace platoon {

double now() {
  return ros::SteadyTime::now().toSec();
}

ros::TransportHints no_delay() {
  return ros::TransportHints().tcpNoDelay(true);
}

void publish(const ros::Publisher& publisher, const stochastic_platoon::Position::Ptr& message) {
  static SpinLock one_at_a_time;
  const std::lock_guard<SpinLock> lock(one_at_a_time);
  publisher.publish(message);
}

}  // namespace platoon
