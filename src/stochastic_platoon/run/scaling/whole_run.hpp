#pragma once

#include <string>

#include "stochastic_platoon/run/report/prediction.hpp"
#include "stochastic_platoon/run/results/run_result.hpp"
#include "stochastic_platoon/run/scaling/shard_run.hpp"

namespace platoon {

/// The result of a whole run with the prediction of the theory.
struct WholeRun {
  Prediction prediction;
  RunResult result;
  std::string unsaved = {};  ///< the reason why the folder does not hold the results; empty if it does
};

/// Computes a run in this process. With an output folder, locks it, continues an interrupted run there, and writes the
/// results so far; without one, only returns them, and none of a run that was stopped. Throws as compute_shard() does,
/// but if the folder cannot be written at the end, the results are returned.
WholeRun compute_run(Configuration configuration, const ShardSettings& settings);

}  // namespace platoon
