#pragma once

#include <ros/node_handle.h>

#include <memory>
#include <vector>

#include "stochastic_platoon/ros/hosting/segments.hpp"
#include "stochastic_platoon/ros/nodes/channel.hpp"
#include "stochastic_platoon/ros/nodes/follower.hpp"
#include "stochastic_platoon/ros/nodes/leader.hpp"
#include "stochastic_platoon/ros/nodes/monitor.hpp"
#include "stochastic_platoon/ros/nodes/recorder.hpp"
#include "stochastic_platoon/ros/observation/diagnostics.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"

namespace platoon {

/// The whole platoon in one process: the components of the nodes, connected by shared pointers, with one thread per
/// core. Each component is built on one thread's queue and needs no lock, except the monitor, which is built on all
/// queues.
class OneProcess {
public:
  /// Throws ConfigurationError as Monitor and Recorder do. `superseded` is called with the configuration that replaces
  /// the present one.
  OneProcess(const ros::NodeHandle& platoon, const Configuration& configuration, std::size_t threads,
             const RunMembership::Join& superseded);
  ~OneProcess();

  /// Starts the threads; they end when ROS shuts down.
  void start();

  /// Ends the threads and saves an unfinished run. Rethrows the error that ended a thread, if any.
  void stop();

private:
  class Worker;
  const Worker& worker_of(std::size_t vehicle) const { return *workers_[segments_.thread_of(vehicle)]; }

  Segments segments_;
  std::vector<std::unique_ptr<Worker>> workers_;
  std::unique_ptr<Monitor> monitor_;
  std::unique_ptr<Recorder> recorder_;
  std::vector<std::unique_ptr<Channel>> channels_;
  std::vector<std::unique_ptr<Follower>> followers_;
  std::unique_ptr<Leader> leader_;
  std::unique_ptr<Diagnostics> diagnostics_;
};

}  // namespace platoon
