#pragma once

#include <ros/node_handle.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "stochastic_platoon/run/configuration/configuration.hpp"

namespace platoon {

/// The parameter `configuration` of the platoon's namespace: JSON text that `configure` generates from launch arguments
/// and model file; none if it is not set. Throws ConfigurationError if it is invalid.
std::optional<Configuration> read_configuration(const ros::NodeHandle& platoon);

/// The same, but waits until the parameter is set; none if ROS shuts down first.
std::optional<Configuration> wait_for_configuration(const ros::NodeHandle& platoon);

/// The run that a component takes part in. Every message carries its run's identity; on a message of another run, the
/// component checks whether that run has become the platoon's.
class RunMembership {
public:
  /// Called when the platoon's configuration has become that of a message's run. Returns whether the component takes
  /// part in this run, too; if not, the component is over. May throw std::exception if the component cannot take part
  /// but waits for another run: the message is then dropped and the reason reported.
  using Join = std::function<bool(const Configuration&)>;

  /// `name`: the component's name in messages, "vehicle_3". `run`: the run that it takes part in; 0: none yet.
  RunMembership(const ros::NodeHandle& platoon, std::string name, std::uint64_t run, Join join);
  ~RunMembership();

  /// Whether a message of this run counts. For an unknown run it reads the parameter server, at most five times a
  /// second for the same run and twenty for all.
  bool admits(std::uint64_t run) { return run == run_.load(std::memory_order_relaxed) || looks_and_admits(run); }

  /// Calls Join, and makes the run of this configuration the present one if the component takes part in it.
  void join(const Configuration& configuration);

  /// Notifies leader and monitor that this component has missed messages of an attempt, once per attempt.
  void notify_missed(std::uint32_t attempt);

  std::uint64_t run() const { return run_.load(std::memory_order_relaxed); }

  /// Whether a run has begun that the component takes no part in.
  bool is_over() const { return over_.load(std::memory_order_relaxed); }

private:
  bool looks_and_admits(std::uint64_t run);
  void reject(std::uint64_t run, const std::string& reason);
  void notify(std::uint8_t kind, std::uint64_t run, std::uint32_t attempt, const std::string& note);

  ros::NodeHandle platoon_;
  std::string name_;
  Join join_;
  std::atomic<std::uint64_t> run_;
  std::atomic<bool> over_{false};
  std::mutex looking_;
  std::uint64_t last_unknown_ = 0;
  std::optional<double> last_look_;  ///< [s]
  std::string last_reason_;
  std::optional<std::pair<std::uint64_t, std::uint32_t>> missed_;  ///< run and attempt of the latest notice
  ros::Publisher notices_;                                         ///< on `progress`, advertised with the first notice
};

}  // namespace platoon
