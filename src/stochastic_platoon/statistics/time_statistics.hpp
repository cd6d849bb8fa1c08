#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "stochastic_platoon/statistics/moments.hpp"

namespace platoon {

/// Mean and variance of every zeta_i over the steps k >= burn_in of one realization: time averages.
///
/// Successive errors are correlated, so the standard errors of independent values do not hold for these.
class TimeStatistics {
public:
  TimeStatistics(std::size_t followers, std::int64_t burn_in) : burn_in_(burn_in), moments_(followers) {}

  /// zeta_i(k) [m], follower i >= 1.
  void add(std::size_t follower, std::int64_t step, double error) {
    if (step >= burn_in_) moments_.at(follower - 1).add(error);
  }

  void restart() { moments_.assign(moments_.size(), Moments{}); }

  /// One per follower; count is the number of steps behind it.
  const std::vector<Moments>& moments() const { return moments_; }

private:
  std::int64_t burn_in_;
  std::vector<Moments> moments_;
};

}  // namespace platoon
