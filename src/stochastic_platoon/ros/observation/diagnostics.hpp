#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/node_handle.h>

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "stochastic_platoon/ros/transport/activity.hpp"
#include "stochastic_platoon/ros/transport/drop_counter.hpp"

namespace platoon {

/// What a component, or all of a kind in one process, has done and dropped: the figures that all have in common.
class VitalSigns {
public:
  /// Streams of messages, each with those that were dropped of it; null: none are.
  using Sources = std::vector<std::pair<const Activity*, const DropCounter*>>;

  explicit VitalSigns(Sources sources) : sources_(std::move(sources)) {}

  /// Adds step, rate, attempts and messages dropped by reason; a warning where messages were dropped since the last
  /// time that should not have come.
  void add_to(diagnostic_updater::DiagnosticStatusWrapper& status);

private:
  Sources sources_;
  double last_time_ = 0.0;  ///< [s]
  std::uint64_t last_messages_ = 0;
  std::uint64_t last_faults_ = 0;
};

/// The statuses of one process on /diagnostics, once a second: one per kind of component, however many vehicles it
/// hosts. The first comes seconds after the start, when a platoon has better things to do with its master.
class Diagnostics {
public:
  using Fill = std::function<void(diagnostic_updater::DiagnosticStatusWrapper&)>;

  explicit Diagnostics(const ros::NodeHandle& platoon);

  /// Call it before the first second is over. `fill` is called by the thread that serves the node handle.
  void add(const std::string& name, Fill fill);

private:
  void update();

  ros::NodeHandle platoon_;
  std::vector<std::pair<std::string, Fill>> fills_;
  int seconds_ = 0;
  std::unique_ptr<diagnostic_updater::Updater> updater_;
  ros::SteadyTimer timer_;
};

/// A status of these figures alone.
inline Diagnostics::Fill vital_signs(VitalSigns::Sources sources) {
  return [signs = VitalSigns(std::move(sources))](diagnostic_updater::DiagnosticStatusWrapper& status) mutable {
    signs.add_to(status);
  };
}

}  // namespace platoon
