#pragma once

#include <string>
#include <vector>

#include "stochastic_platoon/configuration/configuration.hpp"
#include "stochastic_platoon/results/run_result.hpp"
#include "stochastic_platoon/statistics/shard.hpp"

namespace platoon {

/// A run that was joined of its shards.
struct MergedRun {
  Configuration configuration;
  RunResult result;
};

/// "0-2,5": numbers in ascending order, as sbatch --array takes them.
std::string array_indices(const std::vector<std::uint64_t>& ascending);

/// Joins the shards that these folders hold, in any order, to the run that they are of: the bits of one run.
///
/// One shard is in memory at a time, beside the sums of what lies before it. Throws ConfigurationError with all that
/// is wrong: folders that hold no shard or a damaged one, shards that are not complete, of different runs (and in
/// what they differ) or there twice, and which are missing.
MergedRun merge(const std::vector<std::string>& folders);

}  // namespace platoon
