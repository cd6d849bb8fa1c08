#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "stochastic_platoon/math/statistics/batch_means.hpp"
#include "stochastic_platoon/math/statistics/error_averages.hpp"
#include "stochastic_platoon/math/statistics/recent_moments.hpp"

namespace platoon {

/// Mean and variance of every zeta_i over the steps k >= burn_in of successive realizations: time averages. The steps
/// of an interrupted realization (a killed node) count, and the next realization counts from its own burn_in on.
///
/// A manoeuvre of the leader in steps a .. b departs from the model. It excludes the errors that it affects, zeta_i(k)
/// for k >= a + d_i, up to a burn-in after its end, k <= b + i - 1 + burn_in. The decision requires the leader's step
/// k - d_i, the latest on which zeta_i(k) depends.
///
/// The burn-in is that of linear vehicles. A vehicle that its limits hold back settles later: where a stay at a limit,
/// begun in a manoeuvre, lasts longer than those outside of manoeuvres, its errors and those behind it are excluded up
/// to a burn-in later.
///
/// Until a follower has an average, provisional() has the moments of the latest of its errors, those of a manoeuvre
/// left out. They serve displays alone.
///
/// The errors of a follower are added in the order of their steps, not of their arrival, so the sums have the same
/// bits. Successive errors are correlated: shares() measures their share of independent errors.
class TimeStatistics : public ErrorAverages {
public:
  /// `earlier`: moments() of earlier realizations, one per follower; may be empty. `distances`: the d_i (see
  /// steps_from_leader()); empty: i - 1. `limited`: whether vehicles have limits; their errors then wait for those of
  /// the vehicle ahead, up to the step before.
  TimeStatistics(std::size_t followers, std::int64_t burn_in, std::vector<Moments> earlier = {},
                 std::vector<std::int64_t> distances = {}, bool limited = false);

  void add(const ReducedSignals& signals) override;
  /// No effect: an endless batch is never complete.
  void commit(std::uint64_t) override {}
  void restart() override;
  void saw_leader(std::int64_t step, bool by_model) override;
  std::uint64_t realizations() const override { return 1; }
  bool empty() const override;
  std::int64_t last_step(std::size_t follower) const override { return followers_[follower - 1].next_step - 1; }
  std::int64_t last_counted(std::size_t follower) const override { return followers_[follower - 1].last_counted; }
  std::int64_t counted_from() const override;
  /// One per follower; count is the number of steps in it.
  std::vector<Moments> moments() const override;
  std::vector<Moments> provisional() const override;
  std::vector<IndependentShare> shares() const override;
  const EnsembleTotals* totals() const override { return nullptr; }

private:
  struct Error {
    double value;  ///< zeta_i [m]
    bool at_limit;
  };
  struct Steps {
    std::int64_t from, until;
  };
  struct Follower {
    Moments moments;
    RecentMoments provisional;
    std::int64_t next_step = 0;           ///< next step to add
    std::int64_t last_counted = -1;       ///< latest step in `moments`
    std::map<std::int64_t, Error> early;  ///< of steps received early
    std::vector<Steps> held_back = {};    ///< excluded as limits hold it back, or a vehicle ahead
    std::int64_t held = 0, usual = 0;     ///< steps at a limit in a row: now, and the most outside of manoeuvres

    bool is_held_back(std::int64_t step) const;
    void hold_back(const Steps& added);  ///< joined to the steps that it overlaps or continues
  };
  bool count_due(std::size_t index);
  bool count_next(std::size_t index);
  void hold_back(std::size_t index, std::int64_t step, bool at_limit);
  bool counts(std::size_t follower, std::int64_t step) const;
  bool is_reached(std::size_t follower, std::int64_t step) const;
  bool departs(std::size_t follower, std::int64_t step) const;
  bool measured(std::size_t index) const { return earlier_[index].count + followers_[index].moments.count > 0; }

  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();
  std::int64_t burn_in_;
  std::vector<std::int64_t> distances_;
  bool limited_;
  std::int64_t leader_step_ = kNever;   ///< latest known; kNever: not reported
  std::int64_t departed_ = kNever;      ///< first step of the latest manoeuvre
  std::int64_t counts_from_;            ///< first step counted after it
  std::int64_t counted_from_ = kNever;  ///< first step counted before it
  std::vector<Moments> earlier_;        ///< of earlier realizations, one per follower
  std::vector<Follower> followers_;     ///< of the current realization
  std::vector<BatchMeans> batches_;     ///< of all realizations of this process, one per follower
};

}  // namespace platoon
