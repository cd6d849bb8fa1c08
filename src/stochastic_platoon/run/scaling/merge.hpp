#pragma once

#include <string>
#include <vector>

#include "stochastic_platoon/math/statistics/shard.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"
#include "stochastic_platoon/run/configuration/configuration_error.hpp"
#include "stochastic_platoon/run/results/run_result.hpp"
#include "stochastic_platoon/run/scaling/shard_run.hpp"

namespace platoon {

/// A run joined from its shards.
struct MergedRun {
  Configuration configuration;
  RunResult result;
};

/// The totals joined from shards.
struct MergedShards {
  ShardRun run;  ///< one of them
  EnsembleTotals totals;
  Tally tally;
};

/// "0-2,5": numbers in ascending order, in the format of sbatch --array.
std::string array_indices(const std::vector<std::uint64_t>& ascending);

/// Thrown for folders that do not make a whole run.
class IncompleteRun : public ConfigurationError {
public:
  /// `of`: number of shards of the run, 0 if no folder holds one; `missing` is known only if `of` is above 0.
  IncompleteRun(const std::vector<std::uint64_t>& missing, std::uint64_t of, std::vector<std::string> others);

  /// The shards to compute. `of`: number of shards, used if no folder holds one.
  std::vector<std::uint64_t> missing(std::uint64_t of) const;

  /// All other problems.
  const std::vector<std::string>& others() const { return others_; }

private:
  std::vector<std::uint64_t> missing_;
  std::uint64_t of_;
  std::vector<std::string> others_;
};

/// Joins the shards in these folders, in any order, to their run: bit for bit the result of one run.
MergedRun merge(const std::vector<std::string>& folders);

/// The same for shards of any computation.
///
/// One shard is in memory at a time, beside the sums of the shards before it. Throws IncompleteRun with all problems:
/// folders without a shard or with a damaged one, incomplete shards, shards of different runs (with their differences),
/// duplicate shards, and the missing shards.
MergedShards merge_shards(const std::vector<std::string>& folders);

}  // namespace platoon
