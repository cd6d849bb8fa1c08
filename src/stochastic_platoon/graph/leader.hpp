#pragma once

#include <ros/node_handle.h>
#include <stochastic_platoon/Position.h>
#include <stochastic_platoon/Progress.h>

#include <vector>

#include "stochastic_platoon/configuration/configuration.hpp"
#include "stochastic_platoon/delivery/credit.hpp"
#include "stochastic_platoon/graph/message_pool.hpp"
#include "stochastic_platoon/model/vehicle.hpp"

namespace platoon {

/// Vehicle 0 as a ROS component: the closed loop behind the virtual leader, and the platoon's only clock. It
/// publishes a step when the receivers' progress gives it credit, at most `rate` steps per second, and begins
/// a batch again when it stalls.
///
/// Subscribes: progress. Publishes: vehicle_0/position.
class Leader {
public:
  Leader(ros::NodeHandle platoon, const Configuration& configuration);

private:
  void receive(const stochastic_platoon::Progress::ConstPtr& message);
  void watch();
  void publish_allowed();
  bool publish_one();
  double position_at(std::int64_t step);

  BatchSchedule schedule_;
  ros::Duration period_;
  std::int64_t window_;
  bool paced_;
  Credit credit_;
  LeaderVehicle vehicle_;
  std::vector<double> recorded_;  ///< y_0(-1), y_0(0), ... of a recording; empty: the vehicle's own
  ros::Time stamp_;               ///< of the latest step published; zero before the first
  MessagePool messages_;
  double begin_ = 0.0;  ///< [s] no step before
  ros::Publisher position_;
  ros::Subscriber progress_;
  ros::SteadyTimer stall_timer_;
  ros::SteadyTimer pace_timer_;
};

}  // namespace platoon
