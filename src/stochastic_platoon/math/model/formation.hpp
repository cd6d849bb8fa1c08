#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "stochastic_platoon/math/model/platoon_model.hpp"

namespace platoon {

/// Place of follower i in formation: -(delta_1 + ... + delta_i) [m].
double place_in_formation(const PlatoonModel& model, std::size_t follower);

/// Places of vehicles 0 .. followers in steady motion by `slope` per step, where no vehicle has a spacing error [m]:
/// that of i is the sum of w_j (y_s(j) - late_j) minus that of w_j d_j (slope h + delta). `late` [m] is what the
/// received position lags behind; of any other input, by how much it holds the vehicle back.
std::vector<double> steady_places(const PlatoonModel& model, std::size_t followers, double slope,
                                  const std::function<double(const VehicleModel& own, const Input& input)>& late);

/// Whether the platoon starts in steady motion.
bool starts_steady(const PlatoonModel& model);

/// Displacement of all vehicles per step before step -1: y_0(0) - y_0(-1) = V T_s for a steady start, 0 at rest [m].
double start_slope(const PlatoonModel& model);

/// Mean position of follower i at step -1, without the mean of its InitialPosition: its place in formation, and behind
/// it in steady motion by the headways and the delays of the links up to it [m].
double start_place(const PlatoonModel& model, std::size_t follower);

}  // namespace platoon
