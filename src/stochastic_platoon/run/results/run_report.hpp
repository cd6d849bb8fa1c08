#pragma once

#include <string>

#include "stochastic_platoon/run/results/run_result.hpp"

namespace platoon {

/// The table and the verdict for a terminal. The table has, per follower at the last step, the measured variance with
/// its standard error, the theoretical variance and the score. The verdict reports whether all cells agree, and whether
/// and why the platoon is string stable.
std::string report(const Configuration& configuration, const Prediction& prediction, const RunResult& result);

}  // namespace platoon
