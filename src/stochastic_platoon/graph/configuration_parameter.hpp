#pragma once

#include <ros/node_handle.h>

#include "stochastic_platoon/configuration/configuration.hpp"

namespace platoon {

/// Reads the parameter `configuration` of the platoon's namespace: what `configure` made of the launch
/// arguments and the model file. Throws ConfigurationError when it is not there or not valid.
Configuration read_configuration(const ros::NodeHandle& platoon);

}  // namespace platoon
