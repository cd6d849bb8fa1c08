#pragma once

#include <ros/node_handle.h>
#include <stochastic_platoon/ChangeRun.h>

#include <functional>
#include <map>
#include <optional>
#include <string>

#include "stochastic_platoon/run/configuration/configuration.hpp"

namespace platoon {

/// What becomes of an endless run's configuration when some settings change: the next run of its launch, with a folder
/// and a bag of its own beside those of this one, which stay as they are. Throws ConfigurationError as the launch
/// file's arguments do, and for a run over realizations.
Configuration changed(const Configuration& present, const std::map<std::string, std::string>& given);

/// The service change_run (stochastic_platoon/ChangeRun): headway, noise and loss of an endless run. A new run begins
/// with them in place of the present one, and its statistics start anew. An answer of success is sent once the order
/// is the platoon's configuration on the parameter server, so that no node's end loses it. An order that comes before
/// the one before it has begun changes that one.
class RunChange {
public:
  using Begin = std::function<void(const Configuration&)>;

  /// `begin` is called with the configuration of a run when it has become the platoon's.
  RunChange(ros::NodeHandle platoon, const Configuration& present, Begin begin);

  /// Begins the run that was asked for, if one was. Not from the service itself: its answer is to get through before
  /// the component that serves it ends.
  void begin_if_asked();

private:
  bool serve(stochastic_platoon::ChangeRun::Request& request, stochastic_platoon::ChangeRun::Response& response);

  ros::NodeHandle platoon_;
  Configuration present_;
  Begin begin_;
  std::optional<Configuration> asked_;
  double asked_at_ = 0.0;   ///< [s]
  ros::Publisher notices_;  ///< on `progress`
  ros::ServiceServer service_;
};

}  // namespace platoon
