#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "stochastic_platoon/math/rare/rare_event.hpp"
#include "stochastic_platoon/run/results/rare_results.hpp"
#include "stochastic_platoon/run/scaling/shard_run.hpp"

namespace platoon {

/// An estimation of the probabilities of small gaps.
struct RareRun {
  Configuration configuration;
  RareOptions options;
  std::shared_ptr<const RareEstimator> estimator;

  ShardRun shard(const Shard& shard) const;
  BatchWork work() const;
  /// Number of samples of the whole estimation.
  std::uint64_t samples() const { return estimator->samples(configuration.run.realizations); }
};

/// Reads the options `below`, `method` and `speed` of a command line or a call. Throws ConfigurationError.
RareOptions rare_options(const std::map<std::string, std::string>& given);

/// Throws ConfigurationError, with all problems, if the method does not apply to the model, the steps leave no place
/// for the event, or a vehicle is external.
void require_applicable(const Configuration& configuration, const RareOptions& options);

/// The estimation by the given method, or by that of the model if it is empty or "auto": conditioned realizations for
/// normal errors, splitting for all others; see require_an_estimate(). Throws as require_applicable() does, and for an
/// event that cannot happen or is no rare one. `threads`: of a splitting's pilot.
RareRun rare_run(const Configuration& configuration, RareOptions options, unsigned threads);
/// The estimation to which a shard belongs.
RareRun rare_run(const ShardRun& shard, unsigned threads);

/// The result of an estimation, complete or not.
struct RareResult {
  std::uint64_t samples = 0;
  std::vector<RareRow> rows = {};                 ///< none without samples
  std::map<std::string, std::string> files = {};  ///< rare.csv and rare.json
  std::string report = {};
};
RareResult rare_result(const RareRun& run, const EnsembleTotals& totals);

/// Computes an estimation. With an output folder: locks it, continues an interrupted one there, and writes the files if
/// it is complete. Throws as compute_shard() does, and ConfigurationError if the folder holds a rare.csv.
RareResult compute_rare(RareRun run, const ShardSettings& settings);

/// Writes the files of a result into the locked folder. Throws std::runtime_error, and ConfigurationError as above.
void write_rare(const std::string& output, const RareResult& result);

/// A probability of a small gap of any follower that is asked for, and the key of the model that is to reach it.
struct RareRequirement {
  double probability;  ///< in (0, 1)
  bool per_hour;       ///< instead of per run
  std::string over;    ///< standstill_distance or time_headway
};

/// Reads the options `required`, `per` and `over`; none without `required`. Throws ConfigurationError.
std::optional<RareRequirement> rare_requirement(const std::map<std::string, std::string>& given);

/// The smallest value of the key that satisfies the requirement, to 1e-3 of itself, by estimations with the same draws:
/// the upper 95 % limits of all rows do. Where the levels of a row die out, the last level reached does.
/// `estimation`: that of the model with a value of the key. `start`: where the search begins. `tried`: called with each
/// value and its figure. Throws ConfigurationError if it finds none within a factor of 100 of the start.
double required_value(const RareRequirement& requirement, double start,
                      const std::function<RareRun(double value)>& estimation, const ShardSettings& settings,
                      const std::function<void(double value, double figure)>& tried);

/// Throws ConfigurationError if no row has an estimate or an upper limit.
void require_an_estimate(const RareRun& run);

/// Throws ConfigurationError if the folder has the results of an estimation.
void require_no_rare_results(const std::string& output);

/// The row of a follower, or of "any" (also if `vehicle` is empty), in a string of so many. Throws ConfigurationError.
std::size_t rare_row(const std::string& vehicle, std::size_t followers);

/// A sample in which the event happens, to be simulated as this realization of these draws.
struct RareReplay {
  std::uint64_t realization;
  std::shared_ptr<const ChangedDraws> changes;  ///< valid as long as the estimator
};

/// `vehicle`: see rare_row(). `only`: number of a conditioned realization, or of a
/// repetition of a splitting; empty for the most likely realization, or for the first repetition that has the event.
/// Throws ConfigurationError.
RareReplay rare_replay(const RareRun& run, const std::string& vehicle, const std::string& only);

}  // namespace platoon
