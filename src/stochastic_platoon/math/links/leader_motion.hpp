#pragma once

#include <cstddef>

#include "stochastic_platoon/math/response/vehicle_response.hpp"

namespace platoon {

/// r_0 [m] from step -1 to step steps - 1, without the rounding of large positions to double.
VehicleResponse::Sequence virtual_leader(const PlatoonModel& model, std::size_t steps);

/// The leader's motion from step -1 to step steps - 1. Throws std::invalid_argument if the recorded leader ends before.
Motion leader_motion(const PlatoonModel& model, std::size_t steps);

}  // namespace platoon
