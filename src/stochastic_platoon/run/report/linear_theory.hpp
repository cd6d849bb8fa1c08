#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "stochastic_platoon/run/configuration/configuration.hpp"

namespace platoon {

/// The configuration of the same cars without limits: see without_limits().
Configuration linear_configuration(Configuration configuration);

/// See probability_beyond_limits(), one cell per follower and step; empty in an endless run, and without a theory of
/// normal inputs for the cars without limits.
std::vector<double> beyond_limits(const Configuration& configuration);

/// The lines of a report for these cells: the largest of each follower.
std::string beyond_limits_report(const Configuration& configuration, const std::vector<double>& cells);

/// For summary.json: verdict and stationary variances of the same cars without limits, and the largest of
/// beyond_limits() of each follower.
nlohmann::json linear_json(const Configuration& configuration);

}  // namespace platoon
