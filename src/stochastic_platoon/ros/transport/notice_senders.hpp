#pragma once

#include <ros/message_event.h>
#include <ros/node_handle.h>
#include <stochastic_platoon/Progress.h>

#include <string>

#include "stochastic_platoon/math/model/platoon_model.hpp"

namespace platoon {

/// Limits notices that cost a repetition (Progress::MISSED) to the nodes of the platoon: the notice of vehicle_3 counts
/// from the node that publishes vehicle_3/position, that of the channel from the node that publishes the first input of
/// vehicle 1. Of several publishers, the ones in the platoon's namespace count.
///
/// As SolePublisher, this protects against mistakes, not against deception: a node is identified by the name that it
/// gives itself.
class NoticeSenders {
public:
  NoticeSenders(const ros::NodeHandle& platoon, const PlatoonModel& model);

  /// Whether the notice counts. Asks the master; logs a rejected sender, and rejects it for a second without asking
  /// again.
  bool admits(const ros::MessageEvent<const stochastic_platoon::Progress>& event);

private:
  std::string name_space_;     ///< "/platoon/"
  std::string channel_topic_;  ///< "vehicle_1/predecessor_position", or "vehicle_1/inputs/0" without that input
  std::string rejected_;       ///< the node rejected last
  double until_ = 0.0;         ///< [s]
};

}  // namespace platoon
