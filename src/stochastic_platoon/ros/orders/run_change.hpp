#pragma once

#include <ros/node_handle.h>
#include <std_srvs/Trigger.h>

#include <functional>
#include <map>
#include <optional>
#include <string>

#include "stochastic_platoon/run/configuration/configuration.hpp"

namespace platoon {

/// The configuration of the next run of an endless run's launch, with the settings `given` changed: headway,
/// noise_variance, loss. The next run has its own folder and bag beside those of `present`, which stay unchanged.
/// Throws ConfigurationError as the launch file's arguments do, for a setting that no vehicle of the string takes from
/// the default vehicle, and for a run over realizations.
Configuration changed(const Configuration& present, const std::map<std::string, std::string>& given);

/// The service change_run (std_srvs/Trigger): changes headway, noise and loss of an endless run to the values of the
/// parameter change_run, a dictionary that the call consumes: {headway: 2.4, noise_variance: 1.0, loss: 0.1}, each
/// optional. A new run with these settings replaces the present one, and its statistics start anew. The service returns
/// success only after the new configuration is on the parameter server, so that no node failure loses it. An order that
/// arrives before the previous new run has begun changes that run's settings.
class RunChange {
public:
  using Begin = std::function<void(const Configuration&)>;

  /// `begin` is called with the configuration of the new run after it has become the platoon's.
  RunChange(ros::NodeHandle platoon, const Configuration& present, Begin begin);

  /// Begins the requested run, if any. The service callback does not do this itself, because its answer must be sent
  /// before the component that serves it ends.
  void begin_if_asked();

private:
  bool serve(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);

  ros::NodeHandle platoon_;
  Configuration present_;
  Begin begin_;
  std::optional<Configuration> asked_;
  double asked_at_ = 0.0;   ///< [s]
  ros::Publisher notices_;  ///< on `progress`
  ros::ServiceServer service_;
};

}  // namespace platoon
