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

/// The parameter `configuration` of the platoon's namespace, the JSON text that `configure` made of the launch
/// arguments and the model file; none while there is none. Throws ConfigurationError when it is not valid.
std::optional<Configuration> read_configuration(const ros::NodeHandle& platoon);

/// The same, waiting for it; none when ROS shuts down meanwhile.
std::optional<Configuration> wait_for_configuration(const ros::NodeHandle& platoon);

/// Which run a component takes part in. Every message carries its run's identity; a message of another run
/// than the present one makes it look whether that run has become the platoon's.
class RunMembership {
public:
  /// Called when the platoon's configuration has become that of the run that a message belongs to. May throw
  /// std::exception when the component cannot take part: then the message is refused and the reason is told.
  using Join = std::function<void(const Configuration&)>;

  /// `name` is what the component is called in messages, "vehicle_3". `run`: the one that the component lives for, and
  /// no message of a later one counts; 0: it takes part in one after another, and in none yet.
  RunMembership(const ros::NodeHandle& platoon, std::string name, std::uint64_t run, Join join);
  ~RunMembership();

  /// Whether a message of this run counts. Looks at the parameter server for a run that it does not know, at
  /// most five times a second for the same, twenty for any.
  bool admits(std::uint64_t run) { return run == run_.load(std::memory_order_relaxed) || looks_and_admits(run); }

  /// Takes part in the run of this configuration from now on, by Join.
  void join(const Configuration& configuration);

  /// Tells leader and monitor that this component has missed messages of an attempt; once for each.
  void tell_missed(std::uint32_t attempt);

  std::uint64_t run() const { return run_.load(std::memory_order_relaxed); }

  /// Whether another run has taken the place of the one that the component lives for.
  bool is_over() const { return over_.load(std::memory_order_relaxed); }

private:
  bool looks_and_admits(std::uint64_t run);
  void refuse(std::uint64_t run, const std::string& reason);
  void notify(std::uint8_t kind, std::uint64_t run, std::uint32_t attempt, const std::string& note);

  ros::NodeHandle platoon_;
  std::string name_;
  Join join_;
  const bool lives_for_one_;
  std::atomic<std::uint64_t> run_;
  std::atomic<bool> over_{false};
  std::mutex looking_;
  std::uint64_t last_unknown_ = 0;
  std::optional<double> last_look_;  ///< [s]
  std::string last_reason_;
  std::optional<std::pair<std::uint64_t, std::uint32_t>> missed_;  ///< run and attempt of the latest told
  ros::Publisher notices_;  ///< on `progress`, made when there is something to say
};

}  // namespace platoon
