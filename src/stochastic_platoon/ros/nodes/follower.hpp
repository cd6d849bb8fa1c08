#pragma once

#include <ros/node_handle.h>
#include <stochastic_platoon/Position.h>

#include <cstdint>
#include <functional>
#include <optional>

#include "stochastic_platoon/math/model/vehicle.hpp"
#include "stochastic_platoon/ros/messages/message_pool.hpp"
#include "stochastic_platoon/ros/observation/diagnostics.hpp"
#include "stochastic_platoon/ros/transport/position_input.hpp"
#include "stochastic_platoon/ros/transport/run_membership.hpp"
#include "stochastic_platoon/ros/transport/transport.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"
#include "stochastic_platoon/run/delivery/message_order.hpp"

namespace platoon {

/// Vehicle i >= 1 as a ROS component. On its predecessor's step k, as received, it publishes its own step k + 1; on
/// step -1 it first publishes its own step -1. In long strings some vehicles publish their own step k instead: see
/// publishes_ahead().
///
/// It may outlive runs: its links stay up, and on the first message of another run it starts over with that run's
/// configuration.
///
/// Subscribes: vehicle_<i>/predecessor_position. Publishes: vehicle_<i>/position. Both
/// stochastic_platoon/Position.
class Follower {
public:
  using Joined = std::function<void(const Configuration&)>;

  /// Joins the run of `present`, if given. `joined` is called with the configuration of every run that the follower
  /// joins. Throws ConfigurationError if the run has no vehicle of this index.
  Follower(ros::NodeHandle platoon, const std::optional<Configuration>& present, std::uint32_t index,
           const MessagePool& messages, Joined joined = {});

  /// Messages taken and dropped.
  VitalSigns::Sources sources() const { return {{&input_.activity(), &input_.drops()}}; }

private:
  /// State within one run.
  struct RunState {
    BatchSchedule schedule;
    bool is_ahead;
    ros::Duration period;
    FollowerVehicle vehicle;
    MessageOrder order;
    stochastic_platoon::Position::Ptr upcoming = {};  ///< its own next step, unless it is ahead
  };
  void begin(const Configuration& configuration);
  void receive(const PositionEvent& event);
  void publish(const stochastic_platoon::Position::Ptr& message, const MessageId& id, const ros::Time& stamp);

  std::uint32_t index_;
  Joined joined_;
  RunMembership membership_;
  std::optional<RunState> run_state_;
  PositionInput input_;
  MessagePool messages_;
  ros::Publisher position_;
  ros::Subscriber predecessor_position_;
};

}  // namespace platoon
