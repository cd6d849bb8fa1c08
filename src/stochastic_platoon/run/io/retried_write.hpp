#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

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

/// Writes that may fail, as on a full disk, and are retried after a pause.
class RetriedWrite {
public:
  using Log = std::function<void(const std::string&)>;

  /// `failed` gets the error of the first of several consecutive failures; `recovered` is called after the last.
  explicit RetriedWrite(
      Log failed, std::function<void()> recovered = [] {})
      : failed_(std::move(failed)), recovered_(std::move(recovered)) {}

  bool is_due(double now) const { return pause_.is_due(now); }

  /// Runs the work. Returns false if it throws std::runtime_error.
  bool operator()(double now, const std::function<void()>& work) {
    try {
      work();
    } catch (const std::runtime_error& error) {
      if (!pause_.is_on()) failed_(error.what());
      pause_.failed(now);
      return false;
    }
    if (pause_.is_on()) recovered_();
    pause_.succeeded();
    return true;
  }

private:
  Log failed_;
  std::function<void()> recovered_;
  RetryPause pause_;
};

}  // namespace platoon
