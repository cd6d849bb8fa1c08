#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "stochastic_platoon/math/model/platoon_model.hpp"

namespace platoon {

/// E zeta_i(k) [m] for i = 1 .. followers, k = 0 .. steps - 1 behind the model's recorded leader; the index of follower
/// i at step k is (i-1) steps + k.
///
/// The string is linear, so the mean is a run of the string without noise and with the mean initial positions. Throws
/// std::invalid_argument unless followers >= 1, steps >= 1 and the recording has y_0(-1) .. y_0(steps - 1).
std::vector<double> mean_errors_behind_recorded_leader(const PlatoonModel& model, std::size_t followers,
                                                       std::int64_t steps);

}  // namespace platoon
