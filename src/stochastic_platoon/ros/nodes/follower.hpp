#pragma once

#include <ros/node_handle.h>
#include <stochastic_platoon/Position.h>

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/math/model/vehicle.hpp"
#include "stochastic_platoon/ros/messages/message_pool.hpp"
#include "stochastic_platoon/ros/observation/diagnostics.hpp"
#include "stochastic_platoon/ros/transport/position_input.hpp"
#include "stochastic_platoon/ros/transport/run_membership.hpp"
#include "stochastic_platoon/ros/transport/transport.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"
#include "stochastic_platoon/run/delivery/message_order.hpp"
#include "stochastic_platoon/run/delivery/message_sets.hpp"

namespace platoon {

/// Vehicle i >= 1 as a ROS component. When all its inputs of step k have arrived, it publishes its own step k + 1; on
/// step -1 it first publishes its own step -1. In long strings some vehicles publish their own step k instead: see
/// publishes_ahead().
///
/// It may outlive runs: its links stay up, and on the first message of another run it starts over with that run's
/// configuration. A kept follower, one that is to outlive launches, has the topics of a radio from the start: a link
/// that comes up with the run's first message has lost that message.
///
/// Its own control input u(k) is part of step k + 1.
///
/// Subscribes: received_topic() of all its inputs, `vehicle_<i>/predecessor_position` of the paper's; if kept, also
/// `vehicle_<i>/predecessor_input`. Publishes: `vehicle_<i>/position`; to a vehicle that hears its control input
/// `vehicle_<i>/input`, which a kept one always advertises. All stochastic_platoon/Position.
class Follower {
public:
  using Joined = std::function<void(const Configuration&)>;

  /// Joins the run of `present`, if given. `joined` is called with the configuration of every run that the follower
  /// joins. Throws ConfigurationError if the run has no vehicle of this index.
  Follower(ros::NodeHandle platoon, const std::optional<Configuration>& present, std::uint32_t index, bool kept,
           const MessagePool& messages, Joined joined = {});

  /// Messages taken and dropped, on the topics that it has from the start.
  const VitalSigns::Sources& sources() const { return sources_; }

private:
  using Message = stochastic_platoon::Position;

  /// The messages of one step to publish; `input` only if another vehicle hears it.
  struct Own {
    Message::Ptr position, input;
  };

  /// A topic of received values.
  struct Stream {
    PositionInput input;
    bool is_subscribed = false;
    std::optional<std::size_t> number = {};  ///< of the vehicle's input in the present run; none: not needed there
  };

  /// An input in one run.
  struct Heard {
    MessageOrder order;
    std::size_t source;
  };

  /// State within one run.
  struct RunState {
    BatchSchedule schedule;
    bool is_ahead, sends_input;
    ros::Duration period;
    FollowerVehicle vehicle;
    std::vector<Heard> heard;
    MessageSets<Message::ConstPtr> sets;
    Own upcoming = {};  ///< its own next step, unless it is ahead
  };
  void begin(const Configuration& configuration);
  void advertise_input();
  Stream& stream_of(const std::string& topic);
  void subscribe();
  void receive(Stream& stream, const PositionEvent& event);
  void move_on(const std::vector<Message::ConstPtr>& received);
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
  std::optional<ros::Publisher> own_input_;  ///< if not kept, from the first run on in which another vehicle hears it
  std::map<std::string, Stream> streams_;    ///< by topic; each remains once a run has needed it
  bool subscribes_ = false;                  ///< to new streams at once
  VitalSigns::Sources sources_;
};

}  // namespace platoon
