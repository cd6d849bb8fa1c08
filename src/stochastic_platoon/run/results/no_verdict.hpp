#pragma once

#include <optional>
#include <string>

#include "stochastic_platoon/run/results/run_result.hpp"

namespace platoon {

/// Why a result without measured_agreement() is not compared with its theory, as a clause: "3 realizations are too few:
/// ...". None if there is no theory, or nothing was measured.
std::optional<std::string> reason_of_no_verdict(const Configuration& configuration, const Prediction& prediction,
                                                const RunResult& result);

}  // namespace platoon
