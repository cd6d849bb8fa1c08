#pragma once

#include <ros/node_handle.h>
#include <stochastic_platoon/Position.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/math/channel/link.hpp"
#include "stochastic_platoon/ros/messages/message_pool.hpp"
#include "stochastic_platoon/ros/observation/diagnostics.hpp"
#include "stochastic_platoon/ros/observation/snapshots.hpp"
#include "stochastic_platoon/ros/transport/position_input.hpp"
#include "stochastic_platoon/ros/transport/run_membership.hpp"
#include "stochastic_platoon/ros/transport/transport.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"
#include "stochastic_platoon/run/delivery/gap_pairs.hpp"
#include "stochastic_platoon/run/delivery/message_order.hpp"

namespace platoon {

/// The links into followers first .. last as one ROS component. A link without state, such as the paper's, passes every
/// message on at once with the noise of its identifier, so that a restart loses only messages in flight. A link with
/// state takes its messages in turn, as a vehicle does: after a restart it requests a repetition from the leader and
/// waits for a step -1. Like a vehicle, the component may outlive runs.
///
/// Where losses depend on the gap, the message of step k waits for the positions of both ends at step k - 1, so that no
/// vehicle waits for itself.
///
/// Subscribes: `vehicle_<i-1>/position`. Publishes: `vehicle_<i>/predecessor_position`, i = first .. last; likewise
/// `vehicle_<i-1>/input` and `vehicle_<i>/predecessor_input` of a vehicle with a radio. All
/// stochastic_platoon/Position.
class Channel {
public:
  /// `snapshots` takes the positions that the followers receive, stream i - 1 for follower i. `superseded` is called
  /// with the configuration that replaces the present one, if the number of followers, the batch size, the recording or
  /// the topics of the links differ.
  Channel(ros::NodeHandle platoon, const Configuration& configuration, std::uint32_t first, std::uint32_t last,
          const MessagePool& messages, std::shared_ptr<Snapshots> snapshots, RunMembership::Join superseded);

  /// Messages passed on and dropped, per link.
  VitalSigns::Sources sources() const;

private:
  /// An input of a follower, whose messages a wire transmits.
  struct Kind {
    bool carries_positions() const { return signal == InputSignal::position; }

    std::uint32_t follower;
    std::uint32_t input;  ///< its index in VehicleModel::inputs
    InputSignal signal;
    bool depends_on_gap;  ///< its losses depend on it: the wire also receives the positions of both ends
  };
  friend bool operator==(const Kind& one, const Kind& other) {
    return one.follower == other.follower && one.input == other.input && one.signal == other.signal &&
           one.depends_on_gap == other.depends_on_gap;
  }

  /// The messages to transmit, or the positions of an end of the link.
  enum class Role { sent, own, predecessor };

  /// A topic that a wire subscribes to.
  struct Stream {
    Role role;
    PositionInput input;
    std::uint32_t first_loss;                ///< see PositionInput::takes()
    std::optional<MessageOrder> order = {};  ///< of a link that keeps state
  };

  struct Wire {
    Kind kind;
    ros::Publisher received;
    std::optional<Link> link = {};
    std::vector<Stream> streams = {};  ///< sent; if depends_on_gap also own and, with a radio, predecessor
    GapPairs<stochastic_platoon::Position::ConstPtr> waiting = {};  ///< of the sent messages and these positions
  };

  static std::vector<Kind> kinds_of(const Configuration& configuration, std::uint32_t first, std::uint32_t last);
  Wire wire(const Kind& kind);
  bool begin(const Configuration& configuration);
  bool takes(Stream& stream, const PositionEvent& event);
  void receive(Wire& wire, Role role, const stochastic_platoon::Position::ConstPtr& message);
  void transmit(Wire& wire, const stochastic_platoon::Position& message, const LinkEnds& before);

  RunMembership::Join superseded_;
  RunOptions run_;
  std::uint32_t first_, last_;
  std::vector<Kind> kinds_;  ///< of the wires
  RunMembership membership_;
  ros::NodeHandle platoon_;
  MessagePool messages_;
  std::shared_ptr<Snapshots> snapshots_;
  std::vector<Wire> wires_;  ///< never resized after construction: the callbacks point into it
};

}  // namespace platoon
