#pragma once

#include <algorithm>
#include <optional>

namespace platoon {

/// When to retry after a failure: after 1 s, 2 s, 4 s ... and then every 30 s. Uses no clock: the time is an argument
/// [s].
class RetryPause {
public:
  void failed(double now) {
    pause_ = std::min(std::max(2.0 * pause_, 1.0), 30.0);
    next_ = now + pause_;
  }
  void succeeded() { *this = RetryPause(); }

  /// Whether the latest try failed.
  bool is_on() const { return next_.has_value(); }
  bool is_due(double now) const { return !next_ || now >= *next_; }

private:
  double pause_ = 0.0;          ///< [s]
  std::optional<double> next_;  ///< [s]
};

}  // namespace platoon
