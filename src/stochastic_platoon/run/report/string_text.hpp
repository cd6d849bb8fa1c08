#pragma once

#include <string>

#include "stochastic_platoon/run/configuration/configuration.hpp"

namespace platoon {

/// "h = 0.32 s (3.2 sample periods)" of the string's vehicles; "h = 3.5 to 4 s (70 to 80 sample periods)" if they have
/// several; "constant spacing of 9.2 m".
std::string spacing_text(const PlatoonModel& model);

/// " at 25 m/s", of stationary values that depend on the leader's speed at the last step; else empty.
std::string speed_text(const Configuration& configuration);

/// "radio of vehicle i-1".
std::string text_of(const Input& input);

/// The noise variances of what the string's vehicles hear: "P_d = 0.25 to 0.4 m^2, radio 0.04 (m/s^2)^2".
std::string noise_text(const PlatoonModel& model);

/// The string's spacing and noise: "h = 0.32 s (3.2 sample periods), P_d = 0.25 m^2"; for vehicles that hear others
/// than their predecessor what they hear, with the weights.
std::string string_text(const PlatoonModel& model);

}  // namespace platoon
