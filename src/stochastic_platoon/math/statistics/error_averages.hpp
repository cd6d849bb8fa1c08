#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "stochastic_platoon/math/statistics/agreement.hpp"
#include "stochastic_platoon/math/statistics/ensemble_totals.hpp"

namespace platoon {

/// The signals of follower i at step k of one batch of realizations, reduced to their moments.
struct ReducedSignals {
  std::size_t follower;  ///< i >= 1
  std::int64_t step;     ///< k >= 0
  std::uint64_t first_realization;
  std::size_t count;                           ///< realizations in the batch
  std::vector<std::vector<MomentNode>> nodes;  ///< reduce_batch() of the tracking errors, then of each signal
  std::vector<double> gaps = {};               ///< [m], one per realization; empty if the gap is not among the signals
  AtLimits at_limits = {};
};

/// Mean and variance of every tracking error of a run, over realizations or over time, and over realizations of the
/// other signals too. Not thread-safe.
class ErrorAverages {
public:
  virtual ~ErrorAverages() = default;

  /// Adds the signals of a follower at a step of a batch, in any order.
  virtual void add(const ReducedSignals& signals) = 0;

  /// Ends a batch: all its signals have been added.
  virtual void commit(std::uint64_t first_realization) = 0;

  /// The current batch was interrupted and restarts. Over realizations it is discarded and repeated; over time its
  /// errors so far count.
  virtual void restart() = 0;

  /// Reports step k of the leader, and whether the leader follows the model there. Averages over time exclude errors
  /// caused by a manoeuvre of the leader, as the theory does not cover them.
  virtual void saw_leader(std::int64_t, bool) {}

  /// Number of realizations in the averages.
  virtual std::uint64_t realizations() const = 0;

  /// Whether the averages contain no value.
  virtual bool empty() const = 0;

  /// The latest step that a follower has reached; -1 before the first.
  virtual std::int64_t last_step(std::size_t follower) const = 0;

  /// The latest step whose error the average of a follower includes; over time -1 if it has none of the present
  /// realization.
  virtual std::int64_t last_counted(std::size_t follower) const { return last_step(follower); }

  /// The first step from which on the averages of all followers include every error, unless the leader departs from
  /// the model again.
  virtual std::int64_t counted_from() const { return 0; }

  /// Moments per cell (see SignalCells), or of the errors of each follower for averages over time.
  virtual std::vector<Moments> moments() const = 0;

  /// Over time, while some follower has no average yet: of each such follower, moments over the latest part of its
  /// errors so far, which the burn-in excludes from moments(). Else empty.
  virtual std::vector<Moments> provisional() const { return {}; }

  /// Over time: the measured share of independent errors of each follower (see BatchMeans); else empty.
  virtual std::vector<IndependentShare> shares() const { return {}; }

  /// Totals from which another run can continue, for averages over realizations. Null over time, where moments()
  /// suffices.
  virtual const EnsembleTotals* totals() const = 0;
};

}  // namespace platoon
