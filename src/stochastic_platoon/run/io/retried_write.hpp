#pragma once

#include <functional>
#include <stdexcept>
#include <string>
#include <utility>

#include "stochastic_platoon/run/io/retry_pause.hpp"

namespace platoon {

/// Writes that may fail, as on a full disk, and are retried after a pause. Uses no clock: times are arguments [s].
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
