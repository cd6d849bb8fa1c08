#pragma once

#include <malloc.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <chrono>
#include <exception>
#include <limits>
#include <thread>

namespace platoon {

/// Keeps freed memory for the next message: given back to the system and asked for again, every 64 kB message
/// would cost its page faults. What is kept is bounded by what was in use at once, which credit bounds.
inline void keep_freed_memory() {
  mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
  mallopt(M_MMAP_THRESHOLD, 1 << 26);
}

/// ros::spin() without its busy loop at the end: while ROS shuts down, the global queue no longer waits for
/// callbacks, which would cost a hundred vehicles seconds of both cores.
inline void spin() {
  while (ros::ok()) {
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.1));
    if (ros::isShuttingDown()) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
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
