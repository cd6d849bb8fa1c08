#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "stochastic_platoon/math/statistics/agreement.hpp"
#include "stochastic_platoon/math/statistics/batch_moments.hpp"
#include "stochastic_platoon/math/statistics/moment_table.hpp"
#include "stochastic_platoon/math/statistics/moments.hpp"

namespace platoon {

/// Domain of the mean and the variance of a tracking error.
enum class Averaging { over_realizations, over_time };

/// Index of zeta_i(k) in tables over followers and steps: row i - 1, column k. i >= 1, 0 <= k < steps.
inline std::size_t cell(std::size_t follower, std::int64_t step, std::int64_t steps) {
  return (follower - 1) * static_cast<std::size_t>(steps) + static_cast<std::size_t>(step);
}

/// zeta_i(k) of one batch of realizations, reduced to its moments.
struct ReducedErrors {
  std::size_t follower;  ///< i >= 1
  std::int64_t step;     ///< k >= 0
  std::uint64_t first_realization;
  std::size_t count;              ///< realizations in the batch
  std::vector<MomentNode> nodes;  ///< reduce_batch() of the errors
};

/// Mean and variance of every tracking error of a run, over realizations or over time. Not thread-safe.
class ErrorAverages {
public:
  virtual ~ErrorAverages() = default;

  virtual Averaging averaging() const = 0;

  /// Adds the errors of a follower at a step of a batch, in any order.
  virtual void add(const ReducedErrors& errors) = 0;

  /// Ends a batch: all its errors have been added.
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

  /// The latest step that all followers have reached, and the latest of one follower.
  virtual std::int64_t last_step() const = 0;
  virtual std::int64_t last_step(std::size_t follower) const = 0;

  /// The first step from which on the averages of all followers include every error, unless the leader departs from
  /// the model again.
  virtual std::int64_t counted_from() const { return 0; }

  /// Moments per cell (follower and step), or per follower for averages over time.
  virtual std::vector<Moments> moments() const = 0;

  /// Over time: what the errors of each follower are worth, as measured (see BatchMeans); else empty.
  virtual std::vector<IndependentShare> shares() const { return {}; }

  /// Totals from which another run can continue, for averages over realizations. Null over time: there moments()
  /// serves.
  virtual const MomentTable* totals() const = 0;
};

/// Averages of an earlier launch, over realizations or over time; both may be empty.
struct EarlierAverages {
  const MomentTable* over_realizations = nullptr;
  std::vector<Moments> over_time = {};  ///< one per follower
};

/// Averages for a run of `steps` steps; 0: an endless run, averaged over time from step `burn_in` on.
std::unique_ptr<ErrorAverages> error_averages(std::size_t followers, std::int64_t steps, std::int64_t burn_in,
                                              const EarlierAverages& earlier, KeptMoments kept = KeptMoments::two);

}  // namespace platoon
