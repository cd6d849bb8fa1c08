#pragma once

#include <cstdint>
#include <string>

#include "stochastic_platoon/run/configuration/configuration.hpp"

namespace platoon {

/// The content of trajectories.csv: per vehicle and step of one realization its position, its predecessor's position as
/// received, its control input, its predecessor's control input as received, tracking error and all signals. Values
/// that do not exist are empty. Throws ConfigurationError unless the run has this realization.
std::string trajectories_csv(const Configuration& configuration, std::uint64_t realization);

}  // namespace platoon
