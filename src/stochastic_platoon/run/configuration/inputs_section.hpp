#pragma once

#include <nlohmann/json.hpp>

#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/run/configuration/section.hpp"

namespace platoon {

/// The values of the first position that the key `inputs` of a vehicle gives.
struct GivenInputs {
  bool noise_variance = false, channel = false;
};

/// Reads the key `inputs` of a vehicle, which replaces all inputs of `vehicle`:
///
///     - {signal: position, from: predecessor, weight, noise_variance, channel}
///     - {signal: input, from: leader, gain, noise_variance, channel: {delay, packet, ...}}
///
/// `signal` is one of position, speed, acceleration, input; `from` is predecessor (if omitted), leader, or a number of
/// vehicles ahead. One position or more are required, with weights of sum 1; the noise_variance and the channel of the
/// first may stand at the vehicle instead. Inputs of one packet have the losses of its first input. Reports all
/// problems. The spacing of `vehicle` must be known.
GivenInputs read_inputs(Section& section, VehicleModel& vehicle, bool allow_unstable);

/// JSON for read_inputs(). Of a vehicle that hears its predecessor alone, the noise_variance and the channel of the
/// position stand at the vehicle.
nlohmann::json inputs_json(const VehicleModel& vehicle);

/// If the string has radios, or vehicles that hear others than their predecessor, reports settings that these exclude,
/// and rebuilds every loop with a known control input.
void check_hearing(PlatoonModel& model, Section& document);

}  // namespace platoon
