#pragma once

#include <malloc.h>
#include <ros/ros.h>

#include <exception>
#include <limits>

namespace platoon {

/// Keeps freed memory for the next message: given back to the system and asked for again, every 64 kB message
/// would cost its page faults. What is kept is bounded by what was in use at once, which credit bounds.
inline void keep_freed_memory() {
  mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
  mallopt(M_MMAP_THRESHOLD, 1 << 26);
}

/// The main of a node: `run` builds its component and spins. An error ends the process with status 1 and a
/// FATAL line. A handle outside the try block keeps ROS, and with it the console, alive until the line is
/// out.
template <typename Run>
int run_component(int argc, char** argv, const char* name, std::uint32_t options, const Run& run) {
  keep_freed_memory();
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
