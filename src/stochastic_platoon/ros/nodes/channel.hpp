#pragma once

#include <ros/node_handle.h>
#include <stochastic_platoon/Position.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "stochastic_platoon/math/model/link.hpp"
#include "stochastic_platoon/ros/messages/message_pool.hpp"
#include "stochastic_platoon/ros/observation/diagnostics.hpp"
#include "stochastic_platoon/ros/observation/snapshots.hpp"
#include "stochastic_platoon/ros/transport/position_input.hpp"
#include "stochastic_platoon/ros/transport/run_membership.hpp"
#include "stochastic_platoon/ros/transport/transport.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"
#include "stochastic_platoon/run/delivery/message_order.hpp"

namespace platoon {

/// The links into followers first .. last as one ROS component. A link without state, such as the paper's, passes every
/// message on at once with the noise of its identifier, so that a restart loses only messages in flight. A link with
/// state takes its messages in turn, as a vehicle does: after a restart it requests a repetition from the leader and
/// waits for a step -1. Like a vehicle, the component may outlive runs.
///
/// Subscribes: vehicle_<i-1>/position. Publishes: vehicle_<i>/predecessor_position, i = first .. last; likewise
/// vehicle_<i-1>/input and vehicle_<i>/predecessor_input of a vehicle with a radio. All stochastic_platoon/Position.
class Channel {
public:
  /// `told` takes the positions that the followers receive, stream i - 1 for follower i. `superseded` is called with
  /// the configuration that replaces the present one, if the number of followers, the batch size, the recording or the
  /// vehicles with radios differ.
  Channel(ros::NodeHandle platoon, const Configuration& configuration, std::uint32_t first, std::uint32_t last,
          const MessagePool& messages, std::shared_ptr<Snapshots> told, RunMembership::Join superseded);

  /// Messages passed on and dropped, per link.
  VitalSigns::Sources sources() const;

private:
  struct Wire {
    std::uint32_t follower;
    bool radio;  ///< transmits inputs, not positions
    std::optional<Link> link;
    std::optional<MessageOrder> order;  ///< of a link that keeps state
    PositionInput input;
    ros::Publisher received;
    ros::Subscriber sent;
  };
  void begin(const Configuration& configuration);
  void transmit(Wire& wire, const PositionEvent& event);

  RunMembership::Join superseded_;
  RunOptions run_;
  std::uint32_t first_;
  std::vector<bool> radios_;  ///< whether follower first_, first_ + 1, ... has a radio
  std::atomic<bool> over_{false};
  RunMembership membership_;
  MessagePool messages_;
  std::shared_ptr<Snapshots> told_;
  std::vector<Wire> wires_;  ///< never resized after construction: the callbacks point into it
};

}  // namespace platoon
