#pragma once

#include <string>
#include <vector>

namespace platoon {

/// The arguments of a roslaunch command line that its launch files do not declare, one sentence each with the most
/// similar declared name. roslaunch itself ignores such arguments.
///
/// `folder` holds the launch files of this package. Empty for a launch file of another package, which is not found, and
/// for a command line of another program than roslaunch.
std::vector<std::string> undeclared_arguments(const std::vector<std::string>& command_line, const std::string& folder);

/// The address of the master of a roslaunch command line: that of --port (-p), else `environment` (ROS_MASTER_URI),
/// else that of the default port.
std::string master_address(const std::vector<std::string>& command_line, const char* environment);

}  // namespace platoon
