#pragma once

#include <malloc.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <thread>

#include "stochastic_platoon/graph/configuration_parameter.hpp"

namespace platoon {

/// Keeps freed memory for the next message: given back to the system and asked for again, every 64 kB message
/// would cost its page faults. Kept are 24 messages of every vehicle here, more than are mostly on their way,
/// or at least a MiB; what a rare burst needed beyond is given back. Otherwise a long run would sum up the
/// largest burst of every process.
inline void keep_freed_memory(const RunOptions& run) {
  const std::size_t vehicles = run.hosting == "one_process" ? run.followers + 1 : 1;
  const std::size_t kept =
      std::clamp<std::size_t>(24 * vehicles * run.batch * sizeof(double), 1 << 20, 1 << 30);
  mallopt(M_TOP_PAD, static_cast<int>(kept));
  mallopt(M_TRIM_THRESHOLD, static_cast<int>(kept + kept / 2));
  mallopt(M_MMAP_THRESHOLD, 1 << 25);  // 32 MiB: the most that older glibc takes
}

/// ros::spin() without its busy loop at the end: while ROS shuts down, the global queue no longer waits for
/// callbacks, which would cost a hundred vehicles seconds of both cores.
inline void spin() {
  while (ros::ok()) {
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.1));
    if (ros::isShuttingDown()) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

/// The main of a node: `run` builds its component from the configuration and spins. An error ends the process
/// with status 1 and a FATAL line. A handle outside the try block keeps ROS, and with it the console, alive
/// until the line is out.
///
/// One arena lets all threads of a process use the same freed memory. 0 leaves their number to malloc, for a
/// process whose threads would wait for each other there.
template <typename Run>
int run_component(int argc, char** argv, const char* name, std::uint32_t options, const Run& run,
                  int arenas = 1) {
  if (arenas > 0) mallopt(M_ARENA_MAX, arenas);
  ros::init(argc, argv, name, options);
  ros::NodeHandle platoon;
  try {
    const Configuration configuration = read_configuration(platoon);
    keep_freed_memory(configuration.run);
    run(platoon, configuration);
    return 0;
  } catch (const std::exception& error) {
    ROS_FATAL_STREAM(ros::this_node::getName() << ": " << error.what());
    return 1;
  }
}

}  // namespace platoon
