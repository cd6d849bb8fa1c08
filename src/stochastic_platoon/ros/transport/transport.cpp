#include "stochastic_platoon/ros/transport/transport.hpp"

#include <ros/master.h>
#include <ros/this_node.h>

#include <algorithm>
#include <mutex>

#include "stochastic_platoon/ros/transport/spin_lock.hpp"

namespace platoon {

ros::TransportHints no_delay() {
  return ros::TransportHints().tcpNoDelay(true);
}

std::vector<std::string> registered_publishers(const std::string& topic) {
  XmlRpc::XmlRpcValue request, response, state;
  request[0] = ros::this_node::getName();
  std::vector<std::string> names;
  if (!ros::master::execute("getSystemState", request, response, state, false)) return names;
  for (int t = 0; t < state[0].size(); ++t) {
    if (std::string(state[0][t][0]) != topic) continue;
    for (int n = 0; n < state[0][t][1].size(); ++n) names.push_back(state[0][t][1][n]);
  }
  std::sort(names.begin(), names.end());
  return names;
}

void publish(const ros::Publisher& publisher, const stochastic_platoon::Position::Ptr& message) {
  static SpinLock one_at_a_time;
  const std::lock_guard<SpinLock> lock(one_at_a_time);
  publisher.publish(message);
}

}  // namespace platoon
