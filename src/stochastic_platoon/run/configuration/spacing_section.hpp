#pragma once

#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/run/configuration/section.hpp"

namespace platoon {

/// Reads the keys `spacing`, `time_headway` or `time_headway_seconds`, and `own_acceleration` of a vehicle. Keys that
/// it omits are as in `base`, the default vehicle; null for that vehicle itself. With `spacing: constant` the headway
/// is 0.
void read_spacing(Section& section, const VehicleModel* base, double sample_period, VehicleModel& vehicle);

}  // namespace platoon
