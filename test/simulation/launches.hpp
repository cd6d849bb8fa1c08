#pragma once

#include <map>
#include <random>
#include <string>
#include <vector>

#include "stochastic_platoon/run/configuration/configuration.hpp"

namespace platoon::simulation {

constexpr std::int64_t kEndlessSteps = 40;  ///< an endless run is interrupted after them

/// The settings of a random small launch: paper, radios, losses, unlike cars, limits, inputs of several vehicles. It
/// writes to the folder `name`, and may record to `name`.bag.
std::map<std::string, std::string> random_settings(std::mt19937_64& random, bool endless, const std::string& name);

/// The configuration that platoon.launch passes to its nodes. Throws ConfigurationError as `configure` does.
Configuration launched(const std::map<std::string, std::string>& settings);

/// The configuration that replay.launch passes to its nodes.
Configuration replayed(const std::vector<std::string>& bags, const std::string& output);

/// That of replay.launch drive:=leader, with random followers behind the recorded leader.
Configuration behind_recorded_leader(std::mt19937_64& random, const std::vector<std::string>& bags,
                                     const std::string& output);

/// Describes a launch, for a line of a history.
std::string description(const Configuration& configuration);

/// The same run without what differs from launch to launch.
Configuration of_any_launch(Configuration configuration);

/// statistics.csv as monte_carlo computes it.
const std::string& reference(const Configuration& configuration);

/// The files of a complete recording.
std::vector<std::string> recorded_files(const RunOptions& run);

/// What is wrong with the results of a complete run and, if `recorded`, with its recording; empty if nothing is.
std::string problem_of(const Configuration& configuration, bool recorded);

/// What is wrong with the recording of an endless run without orders to its leader, which was interrupted: its
/// positions are those of the model in as many realizations as it had attempts. Empty if nothing is.
std::string problem_of_endless(const Configuration& configuration, bool power_was_lost);

}  // namespace platoon::simulation
