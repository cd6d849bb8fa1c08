#pragma once

#include <ros/node_handle.h>
#include <stochastic_platoon/Position.h>
#include <stochastic_platoon/Progress.h>

#include <map>
#include <optional>
#include <set>
#include <string>

#include "stochastic_platoon/configuration/configuration.hpp"
#include "stochastic_platoon/delivery/credit.hpp"
#include "stochastic_platoon/graph/run_membership.hpp"
#include "stochastic_platoon/graph/sole_publisher.hpp"
#include "stochastic_platoon/messages/message_pool.hpp"
#include "stochastic_platoon/model/vehicle.hpp"

namespace platoon {

/// Vehicle 0 as a ROS component: the closed loop behind the virtual leader, and the platoon's only clock. It
/// publishes a step when the receivers' progress gives it credit, at most `rate` steps per second, and begins
/// a batch again when it stalls.
///
/// Subscribes: progress (stochastic_platoon/Progress). Publishes: vehicle_0/position
/// (stochastic_platoon/Position).
class Leader {
public:
  /// `superseded` is called with a configuration that has taken the present one's place.
  Leader(ros::NodeHandle platoon, const Configuration& configuration, RunMembership::Join superseded);

private:
  void receive(const ros::MessageEvent<const stochastic_platoon::Progress>& event);
  void watch();
  void publish_allowed();
  bool publish_one();

  RunMembership membership_;
  BatchSchedule schedule_;
  ros::Duration period_;
  std::int64_t window_;
  bool paced_;
  Credit credit_;
  std::set<std::string> holding_;                   ///< receivers that say that they hold the platoon up
  std::map<std::string, SolePublisher> reporters_;  ///< by the receiver they speak for
  LeaderVehicle vehicle_;
  ros::Time stamp_;  ///< of the latest step published; zero before the first
  MessagePool messages_;
  std::optional<double> begin_;  ///< [s] no step before
  ros::Publisher position_;
  ros::Subscriber progress_;
  ros::SteadyTimer stall_timer_;
  ros::SteadyTimer pace_timer_;
};

}  // namespace platoon
