#pragma once

#include <ros/node_handle.h>
#include <stochastic_platoon/Position.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/math/channel/link.hpp"
#include "stochastic_platoon/math/model/recent_positions.hpp"
#include "stochastic_platoon/ros/messages/message_pool.hpp"
#include "stochastic_platoon/ros/messages/topics.hpp"
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
/// Subscribes: sent_topic() of every input of followers first .. last, `vehicle_<i-1>/position` of the paper's, and
/// where losses depend on the gap `vehicle_<i>/position`. Publishes: their received_topic(),
/// `vehicle_<i>/predecessor_position` of the paper's. All stochastic_platoon/Position.
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
    std::uint32_t follower;
    std::uint32_t input;  ///< its index in VehicleModel::inputs
    std::uint32_t source;
    InputSignal signal;
    std::string sent, received;  ///< topics
    bool depends_on_gap;         ///< its losses depend on it: the wire also receives the positions of both ends

    bool of_predecessors_position() const { return received == predecessor_position_topic(follower); }
  };
  friend bool operator==(const Kind& one, const Kind& other);

  /// The messages to transmit, or the positions of an end of the link.
  enum class Role { sent, own, predecessor };

  /// A topic that a wire subscribes to.
  struct Stream {
    Role role;
    PositionInput input;
    std::uint32_t first_loss;                ///< see PositionInput::takes()
    std::optional<MessageOrder> order = {};  ///< of a wire that keeps state
  };

  struct Wire {
    Kind kind;
    ros::Publisher received;
    std::optional<Link> link = {};
    std::optional<Signal> difference = {};  ///< of the source's positions, if the input carries one
    RecentPositions positions = {};         ///< of the source, if so
    std::vector<Stream> streams = {};       ///< sent; if depends_on_gap also own and, unless sent, predecessor
    GapPairs<stochastic_platoon::Position::ConstPtr> waiting = {};  ///< of the sent messages and these positions
  };

  static std::vector<Kind> kinds_of(const Configuration& configuration, std::uint32_t first, std::uint32_t last);
  Wire wire(const Kind& kind);
  bool begin(const Configuration& configuration);
  bool takes(Stream& stream, const PositionEvent& event);
  void receive(Wire& wire, Role role, const stochastic_platoon::Position::ConstPtr& message);
  void transmit(Wire& wire, const stochastic_platoon::Position& message, const LinkEnds& before);
  const std::vector<double>& sent_by(Wire& wire, const stochastic_platoon::Position& message);

  RunMembership::Join superseded_;
  RunOptions run_;
  std::uint32_t first_, last_;
  std::vector<Kind> kinds_;  ///< of the wires
  RunMembership membership_;
  ros::NodeHandle platoon_;
  MessagePool messages_;
  std::shared_ptr<Snapshots> snapshots_;
  double slope_ = 0.0;        ///< start_slope() [m]
  std::vector<double> sent_;  ///< differences of positions, of one message
  std::vector<Wire> wires_;   ///< never resized after construction: the callbacks point into it
};

}  // namespace platoon
