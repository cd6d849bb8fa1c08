#pragma once

#include <ros/node_handle.h>
#include <stochastic_platoon/Position.h>

#include <cstdint>
#include <optional>
#include <vector>

#include "stochastic_platoon/configuration/configuration.hpp"
#include "stochastic_platoon/delivery/message_order.hpp"
#include "stochastic_platoon/graph/drop_counter.hpp"
#include "stochastic_platoon/graph/run_membership.hpp"
#include "stochastic_platoon/graph/sole_publisher.hpp"
#include "stochastic_platoon/graph/transport.hpp"
#include "stochastic_platoon/messages/message_pool.hpp"
#include "stochastic_platoon/model/link.hpp"

namespace platoon {

/// The links into followers first .. last as one ROS component. A link without state, such as the paper's,
/// passes every message on at once with the noise its name calls for, so that a restart has no consequence but
/// what was on the way. One that keeps state takes its messages in turn, as a vehicle does, and so waits for a
/// step -1 after a restart.
///
/// Subscribes: vehicle_<i-1>/position. Publishes: vehicle_<i>/predecessor_position, i = first .. last. Both
/// stochastic_platoon/Position.
class Channel {
public:
  /// `superseded` is called with a configuration that has taken the present one's place.
  Channel(ros::NodeHandle platoon, const Configuration& configuration, std::uint32_t first,
          std::uint32_t last, const MessagePool& messages, RunMembership::Join superseded);

private:
  struct Wire {
    Link link;
    std::optional<MessageOrder> order;  ///< of a link that keeps state
    SolePublisher sender;
    DropCounter drops;
    ros::Publisher received;
    ros::Subscriber sent;
  };
  void transmit(Wire& wire, const PositionEvent& event);

  RunMembership membership_;
  BatchSchedule schedule_;
  MessagePool messages_;
  std::vector<Wire> wires_;  ///< never resized after construction: the callbacks point into it
};

}  // namespace platoon
