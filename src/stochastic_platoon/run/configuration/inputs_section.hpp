#pragma once

#include <nlohmann/json.hpp>

#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/run/configuration/section.hpp"

namespace platoon {

/// The values of the position that the key `inputs` of a vehicle gives.
struct GivenInputs {
  bool noise_variance = false;  ///< of the position
  bool channel = false;         ///< of the position
};

/// Reads the key `inputs` of a vehicle, which replaces the radio and the link of the position of `vehicle`:
///
///     - {signal: position, from: predecessor, noise_variance, channel}
///     - {signal: input, from: predecessor, gain, noise_variance, channel: {delay, ...}}
///
/// The first is required; its noise_variance and channel may stand at the vehicle instead. Keys that both omit have
/// their defaults; only the noise variance, which has none, stays that of `vehicle`. Reports all problems.
GivenInputs read_inputs(Section& section, VehicleModel& vehicle, bool allow_unstable);

/// JSON for read_inputs(), with the noise_variance and the channel of the position at the vehicle.
nlohmann::json inputs_json(const VehicleModel& vehicle);

/// If the string has radios, reports settings that radios exclude, and rebuilds every loop with a known control input.
void check_radios(PlatoonModel& model, Section& document);

}  // namespace platoon
