#include "stochastic_platoon/ros/transport/transport.hpp"

#include <ros/time.h>

#include "stochastic_platoon/ros/transport/spin_lock.hpp"

namespace platoon {

ros::TransportHints no_delay() {
  return ros::TransportHints().tcpNoDelay(true);
}

void publish(const ros::Publisher& publisher, const stochastic_platoon::Position::Ptr& message) {
  static SpinLock one_at_a_time;
  const Locked lock(one_at_a_time);
  publisher.publish(message);
}

}  // namespace platoon
