#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "stochastic_platoon/statistics/error_averages.hpp"

namespace platoon {

/// Mean and variance of every zeta_i over the steps k >= burn_in of one realization after another: time
/// averages. A realization that breaks off, as a node was killed, counts as far as it came, and the next one
/// counts from its own burn_in on.
///
/// The errors of a follower count in the order of their steps, whatever order they come in, so that the sums
/// have the same bits. Successive errors are correlated: the standard errors of independent values do not hold.
class TimeStatistics : public ErrorAverages {
public:
  /// `earlier`: moments() of earlier realizations, one per follower; empty: there were none.
  TimeStatistics(std::size_t followers, std::int64_t burn_in, std::vector<Moments> earlier = {});

  Averaging averaging() const override { return Averaging::over_time; }
  void add(const ReducedErrors& errors) override;
  /// An endless batch is never whole.
  void commit(std::uint64_t) override {}
  void restart() override;
  std::uint64_t realizations() const override { return 1; }
  bool empty() const override;
  std::int64_t last_step() const override;
  std::int64_t last_step(std::size_t follower) const override {
    return followers_[follower - 1].next_step - 1;
  }
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
  std::vector<Moments> earlier_;     ///< of the realizations before, one per follower
  std::vector<Follower> followers_;  ///< in the present one
};

}  // namespace platoon
