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

/// The whole platoon in one process: the components of the nodes, joined by shared pointers, on one thread a
/// core. Each component is built on one thread's queue, so that none needs a lock but the monitor, which is
/// built on all.
class OneProcess {
public:
  /// Throws ConfigurationError as Monitor and Recorder do. `superseded` is called with a configuration that
  /// has taken the present one's place.
  OneProcess(const ros::NodeHandle& platoon, const Configuration& configuration, std::size_t threads,
             const RunMembership::Join& superseded);
  ~OneProcess();

  /// Starts the threads; they end by themselves when ROS shuts down.
  void start();

  /// Ends the threads and writes down what there is of an unfinished run. Throws what ended a thread, if it
  /// was an error.
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
