#pragma once

#include <optional>

namespace platoon {

/// Whether the platoon stands still: from when nothing has arrived for a while until a step is complete again, so that
/// the messages of an attempt that gets no further do not end it. Knows no clock: the time is an argument [s].
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

  /// What has changed since the last look: stalled when nothing has arrived for longer than `patience` [s],
  /// or since the first look when nothing ever has.
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
  bool stepped_ = false;                ///< since the last look
  bool stalled_ = false;
};

}  // namespace platoon
