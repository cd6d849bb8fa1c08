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

/// Vehicle i >= 1 as a ROS component. On its predecessor's step k, as received, it publishes its own step k +
/// 1, on step -1 first its own step -1; in long strings it may be one that publishes its own step k: see
/// publishes_ahead().
///
/// It may outlive runs: its links stay up, and the first message of another run makes it start over under that
/// run's configuration.
///
/// Subscribes: vehicle_<i>/predecessor_position. Publishes: vehicle_<i>/position. Both
/// stochastic_platoon/Position.
class Follower {
public:
  using Joined = std::function<void(const Configuration&)>;

  /// Takes part in the run of `present`, if there is one yet. `joined` is called with the configuration of
  /// every run that it takes part in. Throws ConfigurationError when the run has no vehicle of this index.
  Follower(ros::NodeHandle platoon, const std::optional<Configuration>& present, std::uint32_t index,
           const MessagePool& messages, Joined joined = {});

  /// What it has taken and dropped.
  VitalSigns::Sources sources() const { return {{&input_.activity(), &input_.drops()}}; }

private:
  /// What it is within one run.
  struct RunState {
    BatchSchedule schedule;
    bool is_ahead;
    ros::Duration period;
    FollowerVehicle vehicle;
    MessageOrder order;
    stochastic_platoon::Position::Ptr upcoming = {};  ///< its own next step, of one that does not lead
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
