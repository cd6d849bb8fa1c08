#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "stochastic_platoon/run/configuration/configuration.hpp"

namespace platoon {

/// Number of the roslaunch process that is an ancestor of this process; 0 if there is none.
long roslaunch_process();

/// The command line of this process, or of the roslaunch that started it, from /proc; empty if it cannot be read.
std::vector<std::string> command_line();

/// The origin of results, for summary.json: `configuration` (the resolved model and all run options), `revision` of the
/// sources, `date` (UTC, ISO 8601), `host`, `command_line`.
nlohmann::json provenance(const Configuration& configuration);

/// The results of a finished run in a folder.
struct RecordedResults {
  Configuration configuration;  ///< see recorded_configuration()
  bool complete;
  std::uint64_t realizations;  ///< measured
  nlohmann::json checksums;    ///< checksum() of statistics.csv and of every other table, by name
};

/// The configuration of a run in a file. The hosting of a run without ROS nodes, which a launch file cannot select, is
/// one_process. Throws ConfigurationError as parse_configuration() does, and nlohmann::json::exception.
Configuration recorded_configuration(nlohmann::json document);

/// Reads a summary.json. Throws std::system_error if it cannot be read, std::invalid_argument if it is damaged or
/// states no configuration, ConfigurationError if it comes from another version.
RecordedResults read_summary(const std::string& file);

/// "realizations 200 to 249 of 250" if a complete result is of only the last of a run's realizations, as that of the
/// recording of a resumed run; empty if it is of all, or of averages over time.
std::string part_of_run(const RunOptions& run, std::uint64_t realizations);

}  // namespace platoon
