#pragma once

#include <map>
#include <string>
#include <vector>

namespace platoon {

/// The arguments of a roslaunch command line that its launch files do not declare, one sentence each with the most
/// similar declared name. roslaunch itself ignores such arguments.
///
/// `folder` holds the launch files of this package. Empty for a launch file of another package, which is not found, and
/// for a command line of another program than roslaunch.
std::vector<std::string> undeclared_arguments(const std::vector<std::string>& command_line, const std::string& folder);

/// The arguments of replay.launch that have no effect, or a value out of range, one sentence each. `given` holds them
/// by their names, but `rate` as replay_rate; numbers that are absent or empty are the defaults.
std::vector<std::string> ineffective_arguments(std::map<std::string, std::string> given);

/// Throws ConfigurationError unless the text is a port, 0 for any free one, or empty.
void require_port(const std::string& key, const std::string& text);

/// Whether roslaunch reads this as true.
bool is_true(const std::string& text);

/// The address of the master of a roslaunch command line: that of --port (-p), else `environment` (ROS_MASTER_URI),
/// else that of the default port.
std::string master_address(const std::vector<std::string>& command_line, const char* environment);

}  // namespace platoon
