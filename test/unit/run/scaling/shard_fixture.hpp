#pragma once

#include <memory>
#include <string>

#include "stochastic_platoon/run/results/checkpoint.hpp"
#include "stochastic_platoon/run/scaling/shard_run.hpp"
#include "unit/paper_run.hpp"

namespace platoon {

/// A shard of a run of the paper's example: 2 followers, 3 steps, 1000 realizations.
inline ShardRun paper_shard(const std::string& output, std::uint64_t index, std::uint64_t of) {
  Configuration configuration = paper_run(output);
  configuration.run.realizations = 1000;
  configuration.run.hosting = Hosting::monte_carlo;
  configuration.run.record_compression = "none";
  configuration.run.launch_id = name_of({index, of});
  return {configuration, {index, of}};
}

/// Locks the folder of a shard, as the tools do, and computes it.
inline void compute_locked(const ShardRun& run) {
  const std::unique_ptr<FolderLock> lock = lock_output(run.configuration.run);
  compute_shard(run, {});
}

}  // namespace platoon
