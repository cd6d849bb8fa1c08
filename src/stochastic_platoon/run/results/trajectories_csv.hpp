#pragma once

#include <cstdint>
#include <string>

#include "stochastic_platoon/run/configuration/configuration.hpp"

namespace platoon {

/// The content of trajectories.csv: every vehicle of one realization at every step, with what it received of that step
/// of its predecessor, its control input and that of its predecessor as received, tracking error and all signals.
/// Values that do not exist are empty. Throws ConfigurationError unless the run has this realization.
std::string trajectories_csv(const Configuration& configuration, std::uint64_t realization);

}  // namespace platoon
