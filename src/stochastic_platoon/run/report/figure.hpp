#pragma once

#include <cmath>
#include <optional>
#include <string>

#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"

namespace platoon {

/// Six digits and the unit, empty for a plain number; "none" without a value or for NaN.
inline std::string figure(std::optional<double> value, const std::string& unit) {
  if (!value || std::isnan(*value)) return "none";
  if (std::isinf(*value)) return "beyond the range of double";
  return formatted("%.6g", *value) + (unit.empty() ? "" : " " + unit);
}

/// "h = 0.32 s (3.2 sample periods)", or "constant spacing of 9.2 m".
inline std::string spacing_text(const VehicleModel& vehicle, double sample_period) {
  return vehicle.constant_spacing
             ? formatted("constant spacing of %g m", vehicle.standstill_distance)
             : formatted("h = %g s (%g sample periods)", vehicle.headway * sample_period, vehicle.headway);
}

}  // namespace platoon
