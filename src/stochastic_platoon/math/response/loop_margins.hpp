#pragma once

#include <cstddef>
#include <limits>
#include <optional>

#include "stochastic_platoon/math/model/platoon_model.hpp"

namespace platoon {

/// Robustness of a vehicle's closed loop, opened at the input of its plant. With L = G K H, or L = G K behind a headway
/// filter, or HearingLoop::opened():
struct LoopMargins {
  /// The smallest change of L's phase, of either sign, that makes the loop unstable [deg]: the smallest
  /// |arg(-L)| at a frequency where |L| = 1; NaN if there is none.
  double phase = std::numeric_limits<double>::quiet_NaN();
  /// The smallest further delay of the plant's input that makes the loop unstable [steps], not necessarily whole: the
  /// smallest lag that turns L to -1 at a frequency w where |L| = 1, over w; NaN if there is none.
  double delay = std::numeric_limits<double>::quiet_NaN();
  double sensitivity_peak;  ///< largest |1 / (1 + L)|
  double peak_frequency;    ///< of the sensitivity [rad/sample]
};

/// The margins of a vehicle: none for a loop that was given as such or is not stable. Without a grid of frequencies:
/// |L| = 1 at the sign changes of a polynomial, and the peak is the global minimum of an Attenuation.
std::optional<LoopMargins> loop_margins(const VehicleModel& vehicle);

/// Those of follower i of a string that hears any vehicles ahead.
std::optional<LoopMargins> loop_margins(const VehicleModel& vehicle, std::size_t follower, double sample_period);

/// The worst margins over the vehicles of the string, or none if one of them has none.
std::optional<LoopMargins> loop_margins(const PlatoonModel& model);

}  // namespace platoon
