#pragma once

#include <ros/node_handle.h>
#include <stochastic_platoon/Position.h>
#include <stochastic_platoon/Snapshot.h>

#include <atomic>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/ros/transport/spin_lock.hpp"
#include "stochastic_platoon/run/delivery/snapshot_assembly.hpp"

namespace platoon {

/// A visualization topic: one realization of all streams of positions at the same step, at most 20 times a second.
/// Several threads may receive the streams. A run at full speed assembles snapshots only while the topic has
/// subscribers. A paced run, whose streams are seconds apart, always does, so that a new subscriber gets the next
/// snapshot without delay.
///
/// Publishes: `topic` (stochastic_platoon/Snapshot).
class Snapshots {
public:
  /// `errors`: of all followers if the streams are vehicles 0 .. N; else empty. `sample_period` [s]: for their speeds.
  Snapshots(ros::NodeHandle platoon, const std::string& topic, std::size_t streams, std::vector<Signal> errors = {},
            double sample_period = 1.0);

  /// Whether take() needs positions at present.
  bool wanted() const { return wanted_.load(std::memory_order_relaxed); }

  /// Sets the run's rate [steps/s]; 0: as fast as possible. A paced run assembles snapshots even without subscribers,
  /// at multiples of max(1, ceil(0.05 s * rate)) steps, so that both snapshot topics show the same steps.
  void set_rate(double rate);

  /// Takes a message of a stream.
  void take(std::size_t stream, const stochastic_platoon::Position& message);

private:
  void publish();

  std::vector<Signal> errors_;
  double sample_period_;
  std::atomic<bool> wanted_{false};
  std::atomic<bool> paced_{false};
  SpinLock lock_;
  std::uint64_t run_ PLATOON_GUARDED_BY(lock_) = 0;
  SnapshotAssembly assembly_ PLATOON_GUARDED_BY(lock_);
  ros::Time stamp_ PLATOON_GUARDED_BY(lock_);
  std::optional<Snapshot> complete_ PLATOON_GUARDED_BY(lock_);
  ros::Publisher publisher_;
  ros::SteadyTimer timer_;
};

}  // namespace platoon
