#pragma once

#include <ros/ros.h>

#include <exception>

namespace platoon {

/// The main of a node: `run` builds its component and spins. An error ends the process with status 1 and a
/// FATAL line. A handle outside the try block keeps ROS, and with it the console, alive until the line is
/// out.
template <typename Run>
int run_component(int argc, char** argv, const char* name, std::uint32_t options, const Run& run) {
  ros::init(argc, argv, name, options);
  ros::NodeHandle platoon;
  try {
    run(platoon);
    return 0;
  } catch (const std::exception& error) {
    ROS_FATAL_STREAM(ros::this_node::getName() << ": " << error.what());
    return 1;
  }
}

}  // namespace platoon
