#pragma once

#include <optional>

namespace platoon {

/// Detects that the run has stalled: no message has arrived for a while. The stall ends only when a step is complete,
/// so that messages of an attempt that makes no progress do not end it. Uses no clock: the time is an argument [s].
class StallWatch {
public:
  enum class Change { none, stalled, moving };

  /// A message has arrived.
  void arrived(double now) { last_arrival_ = now; }

  /// A step has arrived from all vehicles.
  void completed_step(double now) {
    last_arrival_ = now;
    stepped_ = true;
  }

  std::optional<double> last_arrival() const { return last_arrival_; }
  bool stalled() const { return stalled_; }

  /// The change since the last call. The run stalls when no message has arrived for longer than `patience` [s], counted
  /// from the first call if none has arrived yet.
  Change look(double now, double patience) {
    if (!last_arrival_) last_arrival_ = now;
    const bool stalled = stalled_ ? !stepped_ : now - *last_arrival_ > patience;
    stepped_ = false;
    if (stalled == stalled_) return Change::none;
    stalled_ = stalled;
    return stalled ? Change::stalled : Change::moving;
  }

private:
  std::optional<double> last_arrival_;  ///< [s]
  bool stepped_ = false;                ///< since the last look()
  bool stalled_ = false;
};

}  // namespace platoon
