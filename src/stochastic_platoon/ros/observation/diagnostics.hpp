#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/node_handle.h>

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "stochastic_platoon/ros/transport/message_counter.hpp"

namespace platoon {

/// The status values common to all components: messages taken and dropped by one component, or by all of a kind in one
/// process. Fills a status of Diagnostics.
class VitalSigns {
public:
  /// The counters of all topics.
  using Sources = std::vector<const MessageCounter*>;

  explicit VitalSigns(Sources sources) : sources_(std::move(sources)) {}

  /// Adds step, rate, attempts and messages dropped by reason; warns if MessageCounter::faults() has grown since the
  /// last call.
  void operator()(diagnostic_updater::DiagnosticStatusWrapper& status);

private:
  Sources sources_;
  double last_time_ = 0.0;  ///< [s]
  std::uint64_t last_messages_ = 0;
  std::uint64_t last_faults_ = 0;
};

/// Publishes the statuses of one process on /diagnostics once a second: one per kind of component, for any number of
/// vehicles. It begins 3 s after the start, as the master is busy until then.
class Diagnostics {
public:
  using Fill = std::function<void(diagnostic_updater::DiagnosticStatusWrapper&)>;

  explicit Diagnostics(const ros::NodeHandle& platoon);

  /// Call it within the first second. `fill` is called by the thread that serves the node handle.
  void add(const std::string& name, Fill fill);

private:
  void update();

  ros::NodeHandle platoon_;
  std::vector<std::pair<std::string, Fill>> fills_;
  int seconds_ = 0;
  std::unique_ptr<diagnostic_updater::Updater> updater_;
  ros::SteadyTimer timer_;
};

}  // namespace platoon
