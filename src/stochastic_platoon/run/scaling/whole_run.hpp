#pragma once

#include "stochastic_platoon/run/report/prediction.hpp"
#include "stochastic_platoon/run/results/run_result.hpp"
#include "stochastic_platoon/run/scaling/shard_run.hpp"

namespace platoon {

/// The result of a whole run with the prediction of the theory.
struct WholeRun {
  Prediction prediction;
  RunResult result;
};

/// Computes a run in this process. With an output folder, locks it, continues an interrupted run there, and writes the
/// results so far; without one, only returns them. Throws as compute_shard() does.
WholeRun compute_run(Configuration configuration, const ShardSettings& settings);

}  // namespace platoon
