#pragma once

#include <optional>

namespace platoon {

/// Notices when nothing arrives any more, and when it does again. Knows no clock: the time is an argument [s].
class StallWatch {
public:
  enum class Change { none, stalled, moving };

  void arrived(double now) { last_arrival_ = now; }
  std::optional<double> last_arrival() const { return last_arrival_; }

  /// What has changed since the last look: stalled when nothing has arrived for longer than `patience` [s],
  /// or since the first look when nothing ever has.
  Change look(double now, double patience) {
    if (!last_arrival_) last_arrival_ = now;
    const bool stalled = now - *last_arrival_ > patience;
    if (stalled == stalled_) return Change::none;
    stalled_ = stalled;
    return stalled ? Change::stalled : Change::moving;
  }

private:
  std::optional<double> last_arrival_;  ///< [s]
  bool stalled_ = false;
};

}  // namespace platoon
