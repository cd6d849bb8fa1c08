#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <limits>
#include <mutex>
#include <vector>

#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/math/statistics/moment_table.hpp"

namespace platoon {

/// What a Monte Carlo of the platoon needs beside the model.
struct Ensemble {
  std::uint64_t seed;
  std::size_t followers;       ///< N >= 1
  std::int64_t steps;          ///< K >= 1: errors at k = 0 .. K - 1
  std::uint64_t realizations;  ///< R >= 1
  std::uint64_t batch;         ///< realizations computed side by side, >= 1
};

/// A range of an ensemble's realizations, computed by any number of threads, each of which takes batch after batch.
/// What it gives does not depend on them, nor on what was there before.
class EnsembleRun {
public:
  /// Goes on from `earlier`, which holds some of the realizations. A thread hands over what it has after so many
  /// seconds, or when it has become much: see read().
  EnsembleRun(const PlatoonModel& model, const Ensemble& ensemble, const RealizationRange& range, MomentTable earlier,
              double hand_over_seconds = std::numeric_limits<double>::infinity());
  /// From nothing.
  EnsembleRun(const PlatoonModel& model, const Ensemble& ensemble, const RealizationRange& range);

  /// Computes until no batch is left to begin. True for the one call, of all threads', that makes the run complete.
  bool work();

  /// Whether all batches are begun.
  bool all_begun() const { return all_begun_; }

  /// Realizations of the range that are computed, handed over or not.
  std::uint64_t done() const { return done_; }

  bool is_complete() const;

  /// Shows all that was handed over.
  void read(const std::function<void(const MomentTable&)>& reader) const;

  /// Gives it away.
  MomentTable release();

private:
  bool take(RealizationRange* batch);
  bool hand_over(MomentTable& own);

  const PlatoonModel model_;
  const Ensemble ensemble_;
  const double hand_over_seconds_;

  mutable std::mutex mutex_;
  std::vector<RealizationRange> waiting_;  ///< the next at the back
  std::uint64_t outstanding_ = 0;          ///< not handed over
  MomentTable table_;

  std::atomic<std::uint64_t> done_{0};
  std::atomic<bool> all_begun_{false};
};

/// Works at a run on this many threads until it is complete. `tick` is called from the calling thread, every tenth
/// of a second and at the end.
void complete(EnsembleRun& run, unsigned threads, const std::function<void()>& tick);

/// Moments of every zeta_i(k) over the realizations, on this many threads. `progress` is called with the
/// realizations done, from the calling thread.
MomentTable monte_carlo(const PlatoonModel& model, const Ensemble& ensemble, unsigned threads,
                        const std::function<void(std::uint64_t)>& progress);

}  // namespace platoon
