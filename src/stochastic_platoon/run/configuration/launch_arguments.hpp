#pragma once

#include <string>
#include <vector>

namespace platoon {

/// The problems with the arguments of a roslaunch command line, one sentence each, as roslaunch ignores arguments that
/// no launch file declares: names that the launch files on the command line do not declare, each with the most similar
/// declared name.
///
/// `folder` holds the launch files of this package. Launch files of other packages are not found: then there is nothing
/// to report, and neither is there for a command line of anything but roslaunch.
std::vector<std::string> undeclared_arguments(const std::vector<std::string>& command_line, const std::string& folder);

/// The address of the master of a roslaunch command line: that of --port (-p), else `environment` (ROS_MASTER_URI),
/// else that of the default port.
std::string master_address(const std::vector<std::string>& command_line, const char* environment);

}  // namespace platoon
