#pragma once

#include <ros/duration.h>
#include <ros/publisher.h>
#include <ros/time.h>
#include <ros/transport_hints.h>
#include <stochastic_platoon/Position.h>

#include <cmath>
#include <cstddef>
#include <mutex>
#include <string>

#include "stochastic_platoon/delivery/batch_schedule.hpp"
#include "stochastic_platoon/graph/spin_lock.hpp"

namespace platoon {

/// Time that never jumps [s].
inline double now() {
  return ros::SteadyTime::now().toSec();
}

/// Queues of data topics are unbounded: memory is bounded by the leader's credit, and a bounded queue would
/// drop.
constexpr std::uint32_t kUnboundedQueue = 0;

/// Publishes a position. roscpp publishes under one lock of the process, which puts a thread that has to wait
/// for it to sleep: the threads of `one_process` would do so all the time. Here they wait awake.
inline void publish(const ros::Publisher& publisher, const stochastic_platoon::Position::Ptr& message) {
  static SpinLock one_at_a_time;
  const std::lock_guard<SpinLock> lock(one_at_a_time);
  publisher.publish(message);
}

/// Without it two messages in a row can wait 40 ms for each other.
inline ros::TransportHints no_delay() {
  return ros::TransportHints().tcpNoDelay(true);
}

/// A paced run is one that others look at: they get this time [s] to link up before its first step (rosbag
/// record -a asks the master for new topics once a second).
constexpr double kObserverTime = 3.0;

inline std::string position_topic(std::size_t vehicle) {
  return "vehicle_" + std::to_string(vehicle) + "/position";
}
inline std::string predecessor_position_topic(std::size_t follower) {
  return "vehicle_" + std::to_string(follower) + "/predecessor_position";
}

inline Turn turn_of(const stochastic_platoon::Position& message) {
  return {message.attempt, message.first_realization, message.step};
}

inline void set_turn(const Turn& turn, stochastic_platoon::Position& message) {
  message.attempt = turn.attempt;
  message.first_realization = turn.first_realization;
  message.step = turn.step;
}

/// T_s as platoon time counts it: whole nanoseconds.
inline ros::Duration platoon_period(double sample_period) {
  return ros::Duration().fromNSec(static_cast<std::int64_t>(std::llround(sample_period * 1e9)));
}

}  // namespace platoon
