#pragma once

#include <ros/node_handle.h>

#include <cstddef>
#include <cstdint>
#include <functional>

#include "stochastic_platoon/ros/transport/run_membership.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"

namespace platoon {

/// What a node's main has beside its component.
struct NodeTraits {
  const char* name;                ///< of the node, where none is given
  std::uint32_t init_options = 0;  ///< of ros::init
  /// Malloc arenas: one lets all threads of a process use the same freed memory. 0 leaves their number to
  /// malloc, for a process whose threads would wait for each other there.
  int arenas = 1;
};

/// The main of a node: `run` builds its component and spins. An error ends the process with status 1 and a
/// FATAL line.
int run_node(int argc, char** argv, const NodeTraits& traits,
             const std::function<void(const ros::NodeHandle& platoon)>& run);

/// Tells the main of a component that another run has begun.
class Superseded {
public:
  /// For the component's constructor.
  RunMembership::Join join() {
    return [this](const Configuration&) { happened_ = true; };
  }

  /// Serves the global callback queue until ROS shuts down or another run has begun.
  void spin() const;

private:
  std::atomic<bool> happened_{false};
};

/// The main of a component that lives for one run: waits for the configuration, runs the component, and begins
/// again when the platoon's run has become another.
int run_component(int argc, char** argv, const NodeTraits& traits,
                  const std::function<void(const ros::NodeHandle& platoon, const Configuration& configuration,
                                           Superseded& superseded)>& run);

/// Keeps freed memory for the next message: given back to the system and asked for again, every 64 kB message
/// would cost its page faults. Kept are 24 messages of each of the vehicles in this process, more than are
/// mostly on their way, or at least a MiB; what a rare burst needed beyond is given back. Otherwise a long run
/// would sum up the largest burst of every process.
void keep_freed_memory(const RunOptions& run, std::size_t vehicles);

}  // namespace platoon
