#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "stochastic_platoon/math/statistics/batch_moments.hpp"
#include "stochastic_platoon/math/statistics/moment_table.hpp"
#include "stochastic_platoon/math/statistics/moments.hpp"

namespace platoon {

/// What the mean and the variance of a tracking error are taken over.
enum class Averaging { over_realizations, over_time };

/// Place of zeta_i(k) in every table over followers and steps: row i - 1, column k. i >= 1, 0 <= k < steps.
inline std::size_t cell(std::size_t follower, std::int64_t step, std::int64_t steps) {
  return (follower - 1) * static_cast<std::size_t>(steps) + static_cast<std::size_t>(step);
}

/// zeta_i(k) of one batch of realizations, reduced to its moments: what is left to be counted.
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

  /// Takes the errors of a follower at a step of a batch, in any order.
  virtual void add(const ReducedErrors& errors) = 0;

  /// All errors of the batch were added.
  virtual void commit(std::uint64_t first_realization) = 0;

  /// The present batch has broken off and is begun again: over realizations it is void, and repeated; over time
  /// it counts as far as it came.
  virtual void restart() = 0;

  /// Step k of the leader has arrived, and whether it drives there by the model. Averages over time leave out what a
  /// manoeuvre of the leader causes, as they would be of no platoon that a theory speaks of.
  virtual void saw_leader(std::int64_t, bool) {}

  /// Realizations behind the figures.
  virtual std::uint64_t realizations() const = 0;

  /// Whether there is anything to show.
  virtual bool empty() const = 0;

  /// The latest step behind the figures, and behind those of a follower.
  virtual std::int64_t last_step() const = 0;
  virtual std::int64_t last_step(std::size_t follower) const = 0;

  /// One per cell: a follower and step, or of time averages a follower.
  virtual std::vector<Moments> moments() const = 0;

  /// Over realizations the totals that another run can go on from; over time these are moments(), and it is null.
  virtual const MomentTable* totals() const = 0;
};

/// What an earlier launch has counted: over realizations, or over time. Both may be none.
struct EarlierAverages {
  const MomentTable* over_realizations = nullptr;
  std::vector<Moments> over_time = {};  ///< one per follower
};

/// For a run of these steps; 0: endless, averaged over time from step `burn_in` on.
std::unique_ptr<ErrorAverages> error_averages(std::size_t followers, std::int64_t steps, std::int64_t burn_in,
                                              const EarlierAverages& earlier, KeptMoments kept = KeptMoments::two);

}  // namespace platoon
