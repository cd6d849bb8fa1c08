#pragma once

#include <ros/node_handle.h>

#include <cstdint>
#include <functional>
#include <string>

#include "stochastic_platoon/ros/transport/message_counter.hpp"
#include "stochastic_platoon/ros/transport/run_membership.hpp"
#include "stochastic_platoon/ros/transport/sole_publisher.hpp"
#include "stochastic_platoon/ros/transport/transport.hpp"
#include "stochastic_platoon/run/delivery/message_order.hpp"

namespace platoon {

/// One topic of positions as a component receives it, with the checks that every message passes, in this order: it
/// belongs to the component's run, it comes from the only publisher of that run, and it is the next one of its vehicle.
/// Dropped messages are counted, and logged at most once a second.
///
/// One thread calls its functions; diagnostics may read from another.
class PositionInput {
public:
  /// `receiver`: added to the topic's name in the log, " (channel)". `external`: name of the external vehicle that
  /// publishes the topic, whose contract a dropped message violates; empty: none.
  PositionInput(RunMembership& membership, const ros::NodeHandle& node, const std::string& topic,
                const std::string& receiver = {}, const std::string& external = {});

  /// Subscribes to the topic, unless it has before. `receive` is called with the messages that pass the first two
  /// checks. The object must then keep its address.
  void subscribe(std::function<void(const PositionEvent&)> receive);

  /// Whether the topic has a publisher.
  bool is_connected() const { return subscriber_.getNumPublishers() > 0; }

  /// The third check. Notifies the leader and the monitor if earlier messages are lost: see MessageOrder::has_missed().
  bool takes(const MessageDescriptor& descriptor, MessageOrder& order, std::int64_t first_loss);

  /// The third check, done by the component: counts the message as taken or dropped. Returns whether it is taken.
  bool takes(DropReason drop, const MessageId& id, std::size_t size);

  const MessageCounter& counter() const { return counter_; }

private:
  bool admits(const PositionEvent& event);

  RunMembership* membership_;
  ros::NodeHandle node_;
  std::string topic_;
  SolePublisher publisher_;
  MessageCounter counter_;
  ros::Subscriber subscriber_;
};

}  // namespace platoon
