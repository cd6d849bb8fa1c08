#pragma once

#include <ros/node_handle.h>

#include <cstddef>
#include <cstdint>
#include <functional>

#include "stochastic_platoon/ros/transport/run_membership.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"

namespace platoon {

/// Settings of a node's process.
struct NodeTraits {
  const char* name;                ///< default name of the node
  const char* purpose;             ///< what the node does, and its parameters: the help
  std::uint32_t init_options = 0;  ///< options of ros::init
  /// Malloc arenas. With 1, all threads of a process reuse the same freed memory. 0: malloc's default, for a process
  /// whose threads would block each other in malloc.
  int arenas = 1;
};

/// The main of a node: `run` builds its component and spins. An error ends the process with status 1 and a
/// FATAL line. Prints the help for --help and the version for --version; any argument that is no name:=value ends the
/// process with status 2 and the reason. Neither needs a master.
int run_node(int argc, char** argv, const NodeTraits& traits,
             const std::function<void(const ros::NodeHandle& platoon)>& run);

/// Ends the launch of this node without an error: interrupts its roslaunch, which then ends all its nodes. roslaunch
/// reports the exit of a required node as an error, whatever its status. Without roslaunch, ends this node. Call it
/// once.
void end_launch();

/// Signals to the main of a component that another run has begun.
class Superseded {
public:
  /// The callback for the component's constructor.
  RunMembership::Join join() {
    return [this](const Configuration&) {
      happened_ = true;
      return false;
    };
  }

  /// Serves the global callback queue until ROS shuts down or another run has begun.
  void spin() const;

private:
  std::atomic<bool> happened_{false};
};

/// The main of a component that lives for one run: waits for the configuration, runs the component, and starts over
/// when the platoon begins another run.
int run_component(int argc, char** argv, const NodeTraits& traits,
                  const std::function<void(const ros::NodeHandle& platoon, const Configuration& configuration,
                                           Superseded& superseded)>& run);

/// Makes malloc keep freed memory for the next message; otherwise every 64 kB message would cost its page faults again.
/// It keeps 24 messages per vehicle in this process, more than are usually in flight, and at least 1 MiB. Memory of
/// rare larger bursts is returned to the system; otherwise a long run would accumulate the largest burst of every
/// process.
void keep_freed_memory(const RunOptions& run, std::size_t vehicles);

}  // namespace platoon
