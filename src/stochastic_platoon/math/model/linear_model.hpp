#pragma once

#include <cstddef>
#include <cstdint>

#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/math/model/signal.hpp"

namespace platoon {

/// The same cars without limits, from the same start behind the same vehicle 0, whose positions up to step steps - 1
/// become those of a recorded drive (steps 0: an endless run, which keeps its profile of speeds).
PlatoonModel without_limits(PlatoonModel model, std::int64_t steps);

/// The deviations of a platoon that starts in steady motion from that motion, y_i(k) - s (k + 1) + s l_i with s =
/// start_slope() and the distance s l_i by which the headways and delays up to it hold follower i back: the same cars,
/// at rest at step -1, behind the deviation of vehicle 0. For linear platoons whose links of positions do not lose.
PlatoonModel in_moving_frame(PlatoonModel model);

/// The control input of a vehicle given by plant and controller that moves by s [m] a step for ever: with G its plant,
/// s / lim (z - 1) G(z) as z tends to 1; 0 with two integrators in G, NaN with none, as it then grows.
double steady_input(const VehicleModel& own, double slope);

/// The value of a signal of follower i in steady motion, minus its value at rest in formation.
double steady_value(const PlatoonModel& model, const Signal& signal, std::size_t follower);

}  // namespace platoon
