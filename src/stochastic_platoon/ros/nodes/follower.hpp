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
#include "stochastic_platoon/run/delivery/message_pairs.hpp"

namespace platoon {

/// Vehicle i >= 1 as a ROS component. On its predecessor's step k, as received, it publishes its own step k + 1; on
/// step -1 it first publishes its own step -1. In long strings some vehicles publish their own step k instead: see
/// publishes_ahead().
///
/// It may outlive runs: its links stay up, and on the first message of another run it starts over with that run's
/// configuration. A kept follower, one that is to outlive launches, has the topics of a radio from the start: a link
/// that comes up with the run's first message has lost that message.
///
/// With a radio it waits for the predecessor's input of the same step, too. Its own input u(k) is part of step k + 1.
///
/// Subscribes: `vehicle_<i>/predecessor_position`; with a radio, or if kept, `vehicle_<i>/predecessor_input`.
/// Publishes: `vehicle_<i>/position`; to a follower with a radio `vehicle_<i>/input`, which a kept one always
/// advertises. All stochastic_platoon/Position.
class Follower {
public:
  using Joined = std::function<void(const Configuration&)>;

  /// Joins the run of `present`, if given. `joined` is called with the configuration of every run that the follower
  /// joins. Throws ConfigurationError if the run has no vehicle of this index.
  Follower(ros::NodeHandle platoon, const std::optional<Configuration>& present, std::uint32_t index, bool kept,
           const MessagePool& messages, Joined joined = {});

  /// Messages taken and dropped.
  VitalSigns::Sources sources() const { return {&input_.counter(), &radio_input_.counter()}; }

private:
  using Message = stochastic_platoon::Position;

  /// The messages of one step to publish; `input` only to a follower with a radio.
  struct Own {
    Message::Ptr position, input;
  };

  /// State within one run.
  struct RunState {
    BatchSchedule schedule;
    bool is_ahead, has_radio, sends_input;
    ros::Duration period;
    FollowerVehicle vehicle;
    MessageOrder order, radio_order;
    Own upcoming = {};                           ///< its own next step, unless it is ahead
    MessagePairs<Message::ConstPtr> pairs = {};  ///< with a radio
  };
  void begin(const Configuration& configuration);
  void advertise_input();
  void subscribe_to_input();
  void receive_position(const PositionEvent& event);
  void receive_input(const PositionEvent& event);
  bool takes(PositionInput& input, MessageOrder& order, const PositionEvent& event);
  void match();
  void move_on(const Message& received, const Message* input);
  Own new_messages(std::size_t size);
  void publish(const Own& own, const MessageId& id, const ros::Time& stamp);

  ros::NodeHandle platoon_;
  std::uint32_t index_;
  bool kept_;
  Joined joined_;
  RunMembership membership_;
  std::optional<RunState> run_state_;
  MessagePool messages_;
  ros::Publisher position_;
  std::optional<ros::Publisher> own_input_;  ///< if not kept, from the first run on in which its follower has a radio
  PositionInput input_, radio_input_;        ///< the latter, if not kept, from the first run on in which it has a radio
};

}  // namespace platoon
