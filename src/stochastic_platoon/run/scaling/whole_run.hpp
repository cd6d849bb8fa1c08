#pragma once

#include "stochastic_platoon/run/report/prediction.hpp"
#include "stochastic_platoon/run/results/run_result.hpp"
#include "stochastic_platoon/run/scaling/shard_run.hpp"

namespace platoon {

/// The Monte Carlo of a whole run, beside what the theory predicts of it.
struct WholeRun {
  Prediction prediction;
  RunResult result;
};

/// Computes a run in this process. With an output folder it is locked, a run that was interrupted there continues, and
/// the results are written as far as the run came; without one they are only returned. Throws as compute_shard() does.
WholeRun compute_run(Configuration configuration, const ShardSettings& settings);

}  // namespace platoon
