#pragma once

#include <stochastic_platoon/Overview.h>

#include <cstdint>
#include <vector>

#include "stochastic_platoon/run/results/run_result.hpp"

namespace platoon {

/// At most `most` of the steps 0 .. steps - 1, evenly spread, including both ends. Throws std::invalid_argument unless
/// steps >= 1 and most >= 2.
std::vector<std::int64_t> spread_steps(std::int64_t steps, std::int64_t most);

/// The summary of a run's statistics, with its field `run` unset. A result without moments (nothing measured yet) gives
/// the theory and NaN for all measured values.
stochastic_platoon::Overview overview_of(const RunOptions& run, const Prediction& prediction, const RunResult& result);

}  // namespace platoon
