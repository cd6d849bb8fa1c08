#pragma once

#include <map>
#include <random>
#include <string>

#include "stochastic_platoon/run/configuration/configuration.hpp"

namespace platoon::simulation {

/// The settings of a random small launch: paper, radios, losses, unlike cars, limits, inputs of several vehicles.
std::map<std::string, std::string> random_settings(std::mt19937_64& random);

/// The configuration that platoon.launch passes to its nodes. Throws ConfigurationError as `configure` does.
Configuration launched(const std::map<std::string, std::string>& settings);

/// statistics.csv as monte_carlo computes it.
const std::string& reference(const Configuration& configuration);

/// What is wrong with the results of a complete run and, if `recorded`, with its recording; empty if nothing is.
std::string problem_of(const Configuration& configuration, bool recorded);

}  // namespace platoon::simulation
