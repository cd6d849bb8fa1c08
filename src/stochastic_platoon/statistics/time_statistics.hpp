#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "stochastic_platoon/statistics/error_averages.hpp"

namespace platoon {

/// Mean and variance of every zeta_i over the steps k >= burn_in of one realization: time averages.
///
/// The errors of a follower count in the order of their steps, whatever order they come in, so that the sums
/// have the same bits. Successive errors are correlated: the standard errors of independent values do not hold.
class TimeStatistics : public ErrorAverages {
public:
  TimeStatistics(std::size_t followers, std::int64_t burn_in) : burn_in_(burn_in), followers_(followers) {}

  Averaging averaging() const override { return Averaging::over_time; }
  void add(const ReducedErrors& errors) override;
  /// An endless batch is never whole.
  void commit(std::uint64_t) override {}
  void restart() override { followers_.assign(followers_.size(), Follower{}); }
  std::uint64_t realizations() const override { return 1; }
  bool empty() const override { return last_step() < 0; }
  std::int64_t last_step() const override;
  /// One per follower; count is the number of steps behind it.
  std::vector<Moments> moments() const override;
  const MomentTable* totals() const override { return nullptr; }

private:
  struct Follower {
    Moments moments;
    std::int64_t next_step = 0;            ///< the step that counts next
    std::map<std::int64_t, double> early;  ///< zeta_i of later steps [m]
  };
  std::int64_t burn_in_;
  std::vector<Follower> followers_;
};

}  // namespace platoon
