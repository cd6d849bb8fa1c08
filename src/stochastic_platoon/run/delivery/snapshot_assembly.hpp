#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "stochastic_platoon/run/delivery/batch_schedule.hpp"

namespace platoon {

/// One realization of several streams at the same step.
struct Snapshot {
  MessageId id;
  std::vector<double> position;         ///< [m], one per stream
  std::vector<double> position_before;  ///< [m] one step earlier
};

/// Assembles snapshots for visualization from streams that are steps apart. A snapshot begins when the stream furthest
/// ahead reaches a new step, if one is due, and is complete when every stream has passed that step. A missing message
/// cancels its snapshot. Uses no clock: the time is an argument [s].
class SnapshotAssembly {
public:
  /// Begins at most one snapshot per `period` [s], on average.
  SnapshotAssembly(std::size_t streams, double period);

  /// Begins snapshots only at steps that are multiples of `steps` >= 1.
  void set_stride(std::int64_t steps) { stride_ = steps; }

  /// Takes a position [m] of a stream. Returns the snapshot that it completes, if any.
  std::optional<Snapshot> take(std::size_t stream, const MessageId& id, double position, double now);

  /// Resets all state except the time when the next snapshot is due.
  void clear();

private:
  using Place = std::pair<std::uint64_t, std::int64_t>;  ///< first realization and step
  struct Latest {
    Place place{0, kNothingYet};
    double position = 0.0;  ///< [m]
  };
  struct Open {
    std::size_t streams = 0;  ///< that have passed
    std::vector<double> position, position_before;
  };
  void begin_if_due(const Place& place, double now);

  std::size_t streams_;
  double period_;
  std::int64_t stride_ = 1;
  double due_ = 0.0;  ///< [s]
  std::uint32_t attempt_ = 0;
  Place furthest_{0, kNothingYet};
  std::vector<Latest> latest_;
  std::map<Place, Open> open_;
};

}  // namespace platoon
