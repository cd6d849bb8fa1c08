#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/math/noise/white_noise.hpp"

namespace platoon {

/// One vehicle in one realization. Sequences begin at step -1 and have steps + 1 values, unless stated.
struct Trajectory {
  std::vector<double> position;  ///< y_i(k) [m]
  /// Each of VehicleModel::inputs as received, up to step steps - 2; empty for vehicle 0.
  std::vector<std::vector<double>> received;
  std::vector<double> input;  ///< v_i(k) = u_i(k-1) [m/s^2]; empty if no follower receives it and it is not measured
  /// From step 0 on: the tracking error, then the signals of the given names; of vehicle 0 empty if they are relative
  /// to a predecessor, and for the control input; empty for the control input of a vehicle that has none.
  std::vector<std::vector<double>> signals;
};

/// Calls `take` with vehicles 0 .. followers, in turn, in one realization of a run, bit for bit. `signals`: see
/// signal_kinds().
void for_each_trajectory(const PlatoonModel& model, const WhiteNoise& noise, std::size_t followers, std::int64_t steps,
                         std::uint64_t realization, const std::vector<std::string>& signals,
                         const std::function<void(const Trajectory&)>& take);

}  // namespace platoon
