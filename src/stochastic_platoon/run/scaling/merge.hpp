#pragma once

#include <string>
#include <vector>

#include "stochastic_platoon/math/statistics/shard.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"
#include "stochastic_platoon/run/configuration/configuration_error.hpp"
#include "stochastic_platoon/run/results/run_result.hpp"

namespace platoon {

/// A run that was joined of its shards.
struct MergedRun {
  Configuration configuration;
  RunResult result;
};

/// "0-2,5": numbers in ascending order, as sbatch --array takes them.
std::string array_indices(const std::vector<std::uint64_t>& ascending);

/// Folders that do not make a whole run.
class IncompleteRun : public ConfigurationError {
public:
  /// `missing` may be known only where one of the shards is there: then `of` is how many there are, else 0.
  IncompleteRun(const std::vector<std::uint64_t>& missing, std::uint64_t of, std::vector<std::string> others);

  /// The shards to compute, of a run of so many where no folder says it.
  std::vector<std::uint64_t> missing(std::uint64_t of) const;

  /// What is wrong beside that.
  const std::vector<std::string>& others() const { return others_; }

private:
  std::vector<std::uint64_t> missing_;
  std::uint64_t of_;
  std::vector<std::string> others_;
};

/// Joins the shards that these folders hold, in any order, to the run that they are of: the bits of one run.
///
/// One shard is in memory at a time, beside the sums of what lies before it. Throws IncompleteRun with all that
/// is wrong: folders that hold no shard or a damaged one, shards that are not complete, of different runs (and in
/// what they differ) or there twice, and which are missing.
MergedRun merge(const std::vector<std::string>& folders);

}  // namespace platoon
