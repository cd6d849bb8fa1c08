#pragma once

#include <ros/message_event.h>
#include <ros/publisher.h>
#include <ros/transport_hints.h>
#include <stochastic_platoon/Position.h>

#include <cstdint>
#include <string>
#include <vector>

namespace platoon {

/// A position with the connection that it came over.
using PositionEvent = ros::MessageEvent<const stochastic_platoon::Position>;

/// Time that never jumps [s].
double now();

/// Queues of data topics are unbounded: memory is bounded by the leader's credit, and a bounded queue would
/// drop.
constexpr std::uint32_t kUnboundedQueue = 0;

/// Without it two messages in a row can wait 40 ms for each other.
ros::TransportHints no_delay();

/// A paced run is one that others look at: they get this time [s] to link up before its first step (rosbag
/// record -a asks the master for new topics once a second).
constexpr double kObserverTime = 3.0;

/// The names of the nodes that the master has as publishers of a topic, sorted, connected to them or not; none
/// when it does not answer.
std::vector<std::string> registered_publishers(const std::string& topic);

/// Publishes a position. roscpp publishes under one lock of the process, which puts a thread that has to wait
/// for it to sleep: the threads of one process would do so all the time. Here they wait awake.
void publish(const ros::Publisher& publisher, const stochastic_platoon::Position::Ptr& message);

}  // namespace platoon
