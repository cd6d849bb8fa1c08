#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "stochastic_platoon/delivery/assembly.hpp"
#include "stochastic_platoon/results/run_result.hpp"
#include "stochastic_platoon/statistics/ensemble_statistics.hpp"
#include "stochastic_platoon/statistics/time_statistics.hpp"

namespace platoon {

/// Statistics of a run from the positions of its vehicles, whether they come from topics or from a bag: an
/// Assembly joined to the ensemble statistics of a run with steps or to the time averages of an endless one.
class RunStatistics {
public:
  /// Starts from the checkpoint if there is one, else with nothing committed. `arithmetic` as in
  /// AssemblyEvents; an endless run, whose errors count in the order of their steps, makes no use of it.
  RunStatistics(const Configuration& configuration, const std::optional<Checkpoint>& start,
                const Arithmetic& arithmetic = do_at_once);
  RunStatistics(const RunStatistics&) = delete;
  RunStatistics& operator=(const RunStatistics&) = delete;

  /// The same with realizations before `first_realization` taken as done with, though nothing is known of
  /// them.
  RunStatistics(const Configuration& configuration, std::uint64_t first_realization);

  Verdict receive(std::size_t vehicle, const Turn& turn, const Positions& positions);

  const Arrivals& arrivals() const { return assembly_.arrivals(); }
  bool endless() const { return configuration_.run.steps == 0; }

  /// Realizations in the statistics; of an endless run 1.
  std::uint64_t realizations() const { return endless() ? 1 : ensemble_.committed().count(); }
  /// Whether there is anything to show.
  bool empty() const { return endless() ? last_step_ < 0 : realizations() == 0; }
  /// The latest step with statistics: steps - 1, or of an endless run the latest step so far.
  std::int64_t last_step() const { return endless() ? last_step_ : configuration_.run.steps - 1; }
  /// One per cell, of an endless run one per follower.
  std::vector<Moments> moments() const;

  RunResult result(bool complete) const;
  Checkpoint checkpoint() const;

  Tally tally;  ///< positions and attempts are counted here; times are for the owner to keep

private:
  RunStatistics(const Configuration& configuration, std::uint64_t first_realization, const Tally& start,
                const Arithmetic& arithmetic);
  void take_errors(std::size_t follower, const Turn& turn, const std::vector<double>& errors);
  void restart();

  Configuration configuration_;
  EnsembleStatistics ensemble_;
  TimeStatistics time_averages_;
  std::int64_t last_step_ = kNothingYet;  ///< of an endless run
  Assembly assembly_;
};

}  // namespace platoon
