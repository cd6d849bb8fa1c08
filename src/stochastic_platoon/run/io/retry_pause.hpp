#pragma once

#include <algorithm>
#include <optional>

namespace platoon {

/// When to try again what has failed: after 1 s, 2 s, 4 s ... and then every 30 s. Knows no clock: the time is an
/// argument [s].
class RetryPause {
public:
  void failed(double now) {
    pause_ = std::min(std::max(2.0 * pause_, 1.0), 30.0);
    next_ = now + pause_;
  }
  void succeeded() { *this = RetryPause(); }

  /// Whether the latest try has failed.
  bool is_on() const { return next_.has_value(); }
  bool is_due(double now) const { return !next_ || now >= *next_; }

private:
  double pause_ = 0.0;          ///< [s]
  std::optional<double> next_;  ///< [s]
};

}  // namespace platoon
