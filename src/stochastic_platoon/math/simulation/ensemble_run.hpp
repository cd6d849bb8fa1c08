#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <limits>
#include <mutex>
#include <string>
#include <vector>

#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/math/statistics/ensemble_totals.hpp"

namespace platoon {

/// Parameters of a Monte Carlo run, in addition to the model.
struct Ensemble {
  std::uint64_t seed;
  std::size_t followers;                  ///< N >= 1
  std::int64_t steps;                     ///< K >= 1: errors at k = 0 .. K - 1
  std::uint64_t batch;                    ///< realizations computed side by side, >= 1
  std::vector<std::string> signals = {};  ///< in addition to the tracking errors: see signal_kinds()
};

/// The computation of batches of realizations, for any number of threads.
struct BatchWork {
  EnsembleTotals none;  ///< without realizations
  std::uint64_t batch;  ///< realizations computed side by side, >= 1
  /// Adds a batch to the totals. Calls `check` at intervals of milliseconds, and passes its exceptions on.
  using Computation =
      std::function<void(const RealizationRange& batch, const std::function<void()>& check, EnsembleTotals& totals)>;
  std::function<Computation()> computation;  ///< called once in every thread
};

/// That of a Monte Carlo run.
BatchWork batch_work(const PlatoonModel& model, const Ensemble& ensemble);

/// Computes a range of realizations in any number of threads, each of which processes batch after batch.
/// The results do not depend on the threads or on the realizations present at the start.
class EnsembleRun {
public:
  EnsembleRun(BatchWork work, const RealizationRange& range, EnsembleTotals earlier,
              double hand_over_seconds = std::numeric_limits<double>::infinity());
  /// A Monte Carlo run that continues from `earlier`, which contains some of the realizations. A thread hands over its
  /// results after hand_over_seconds [s], or when they reach a size limit; see read().
  EnsembleRun(const PlatoonModel& model, const Ensemble& ensemble, const RealizationRange& range,
              EnsembleTotals earlier, double hand_over_seconds = std::numeric_limits<double>::infinity());
  /// Starts without earlier results.
  EnsembleRun(const PlatoonModel& model, const Ensemble& ensemble, const RealizationRange& range);

  /// Computes until no batch is left to start. Returns true in exactly one thread: the one that completes the run.
  bool work();

  /// Starts no further batch: the threads complete and hand over those that they have started. The run is then
  /// incomplete.
  void stop();

  /// Stops, and the threads also leave the batches that they have started, whose realizations are then missing.
  void abandon();

  /// Whether all batches have started, or the run was stopped.
  bool all_begun() const { return all_begun_; }

  /// Number of computed realizations of the range, handed over or not.
  std::uint64_t done() const { return done_; }

  bool is_complete() const;

  /// Calls `reader` with all results handed over so far.
  void read(const std::function<void(const EnsembleTotals&)>& reader) const;

  /// Moves the results out.
  EnsembleTotals release();

private:
  bool take(RealizationRange* batch);
  bool hand_over(EnsembleTotals& own);

  const BatchWork work_;
  const double hand_over_seconds_;

  mutable std::mutex mutex_;
  std::vector<RealizationRange> waiting_;  ///< ranges not started; the next is at the back
  std::uint64_t outstanding_ = 0;          ///< realizations not handed over
  EnsembleTotals totals_;

  std::atomic<std::uint64_t> done_{0};
  std::atomic<bool> all_begun_{false}, abandoned_{false};
};

/// Completes a run, unless it is stopped, with this many threads. Calls `tick` from the calling thread every tenth of a
/// second and at the end. An exception of `tick` abandons the run and is passed on.
void complete(EnsembleRun& run, unsigned threads, const std::function<void()>& tick);

}  // namespace platoon
