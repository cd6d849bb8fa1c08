#pragma once

#include <ros/message_event.h>
#include <ros/publisher.h>
#include <ros/subscriber.h>
#include <ros/transport_hints.h>
#include <stochastic_platoon/Position.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "stochastic_platoon/run/io/clock.hpp"

namespace platoon {

/// A position with the connection over which it arrived.
using PositionEvent = ros::MessageEvent<const stochastic_platoon::Position>;

/// Queues of data topics are unbounded: memory is bounded by the leader's credit, and a bounded queue would drop
/// messages.
constexpr std::uint32_t kUnboundedQueue = 0;

/// TCP_NODELAY: without it two consecutive messages can wait 40 ms for each other.
ros::TransportHints no_delay();

/// Time [s] for observers to connect before the first step of a paced run (rosbag record -a polls the master for new
/// topics once a second).
constexpr double kObserverTime = 3.0;

/// Time [s] for all links of a vehicle to come up. Then one input is enough: a vehicle that outlives runs subscribes to
/// some of its inputs only when a message has shown it the run.
constexpr double kLinkTime = 1.0;

/// Whether a vehicle publishes its position and, `waited` [s] after the first look, subscribes to enough of its inputs,
/// which the publishers in `sent` send it.
template <class Sent>
bool is_linked(const ros::Subscriber& position, const std::vector<Sent>& sent, double waited) {
  const auto is_heard = [](const Sent& input) { return input.publisher.getNumSubscribers() > 0; };
  return position.getNumPublishers() > 0 && (waited < kLinkTime ? std::all_of(sent.begin(), sent.end(), is_heard)
                                                                : std::any_of(sent.begin(), sent.end(), is_heard));
}

/// Publishes a position. roscpp publishes under one lock per process, and waiting threads sleep; the threads of one
/// process would do so all the time. Here they spin instead.
void publish(const ros::Publisher& publisher, const stochastic_platoon::Position::Ptr& message);

}  // namespace platoon
