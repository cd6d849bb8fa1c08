#pragma once

#include <ros/node_handle.h>
#include <stochastic_platoon/Position.h>
#include <stochastic_platoon/Snapshot.h>

#include <atomic>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/math/model/tracking_error.hpp"
#include "stochastic_platoon/ros/transport/spin_lock.hpp"
#include "stochastic_platoon/run/delivery/snapshot_assembly.hpp"

namespace platoon {

/// A topic for those who watch: one realization of all streams of positions at the same step, at most 20 times a
/// second. Streams may be received by several threads. A run at full speed pays for it only while somebody subscribes;
/// a paced one, whose streams are seconds apart, has the next snapshot at hand for whoever comes.
///
/// Publishes: `topic` (stochastic_platoon/Snapshot).
class Snapshots {
public:
  /// `errors`: of every follower, where the streams are vehicles 0 .. N; else empty.
  Snapshots(ros::NodeHandle platoon, const std::string& topic, std::size_t streams,
            std::vector<TrackingError> errors = {});

  /// Whether positions are wanted at present.
  bool wanted() const { return wanted_.load(std::memory_order_relaxed); }

  /// Of a run at this rate [steps/s], 0 as fast as it can. One that is paced has them though nobody subscribes, and at
  /// multiples of as many steps as its rate takes: two topics of it are of the same steps.
  void set_rate(double rate);

  /// Takes a message of a stream.
  void take(std::size_t stream, const stochastic_platoon::Position& message);

private:
  void publish();

  std::vector<TrackingError> errors_;
  std::atomic<bool> wanted_{false};
  std::atomic<bool> paced_{false};
  SpinLock lock_;  ///< of what is below, down to `complete_`
  std::uint64_t run_ = 0;
  SnapshotAssembly assembly_;
  ros::Time stamp_;
  std::optional<Snapshot> complete_;
  ros::Publisher publisher_;
  ros::SteadyTimer timer_;
};

}  // namespace platoon
