#pragma once

#include <stochastic_platoon/Overview.h>

#include <cstdint>
#include <vector>

#include "stochastic_platoon/run/results/run_result.hpp"

namespace platoon {

/// At most `most` of the steps 0 .. steps - 1, evenly spread, both ends among them. Throws std::invalid_argument
/// unless there are steps and `most` is at least 2.
std::vector<std::int64_t> spread_steps(std::int64_t steps, std::int64_t most);

/// The message that shows a run's statistics at a glance, without `run`. A result without moments is that of a run of
/// which nothing is measured yet: the theory is there, what is measured NaN.
stochastic_platoon::Overview overview_of(const RunOptions& run, const Prediction& prediction, const RunResult& result);

}  // namespace platoon
