#pragma once

#include <ros/node_handle.h>

#include "stochastic_platoon/run/configuration/configuration.hpp"

namespace platoon {

/// Sets the settings of the run, and those values of the model that settings override, as parameters with the names of
/// the launch arguments; a value that the vehicles do not share, or that is no number, is an empty text. `model` and
/// `leader` are not set: the configuration does not hold the names of their files. They are for users, as in `rosparam
/// get /platoon/headway`; nodes read only the parameter `configuration`, so that they never see a mixture of two runs.
/// Integers beyond 32 bits, which XML-RPC lacks, become text.
void set_run_parameters(const ros::NodeHandle& platoon, const Configuration& configuration);

}  // namespace platoon
