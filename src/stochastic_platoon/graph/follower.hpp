#pragma once

#include <ros/node_handle.h>
#include <stochastic_platoon/Position.h>

#include "stochastic_platoon/configuration/configuration.hpp"
#include "stochastic_platoon/delivery/sequence.hpp"
#include "stochastic_platoon/graph/message_pool.hpp"
#include "stochastic_platoon/graph/refusals.hpp"
#include "stochastic_platoon/model/vehicle.hpp"

namespace platoon {

/// Vehicle i >= 1 as a ROS component. On its predecessor's step k, as received, it publishes its own step k +
/// 1; on step -1 first its own step -1.
///
/// Subscribes: vehicle_<i>/predecessor_position. Publishes: vehicle_<i>/position. Both
/// stochastic_platoon/Position.
class Follower {
public:
  Follower(ros::NodeHandle platoon, const Configuration& configuration, std::uint32_t index,
           const MessagePool& messages);

private:
  void receive(const stochastic_platoon::Position::ConstPtr& message);
  void publish(const stochastic_platoon::Position::Ptr& message, const Turn& turn, const ros::Time& stamp);

  BatchSchedule schedule_;
  ros::Duration period_;
  FollowerVehicle vehicle_;
  Sequence sequence_;
  Refusals refusals_;
  MessagePool messages_;
  ros::Publisher position_;
  ros::Subscriber predecessor_position_;  ///< last: its thread may be ahead of the constructor
};

}  // namespace platoon
