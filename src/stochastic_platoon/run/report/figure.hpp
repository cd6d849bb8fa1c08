#pragma once

#include <cmath>
#include <optional>
#include <string>

#include "stochastic_platoon/math/numerics/text.hpp"

namespace platoon {

/// Six digits and the unit, empty for a plain number; "none" without a value or for NaN.
inline std::string figure(std::optional<double> value, const std::string& unit) {
  if (!value || std::isnan(*value)) return "none";
  if (std::isinf(*value)) return "beyond the range of double";
  return formatted("%.6g", *value) + (unit.empty() ? "" : " " + unit);
}

}  // namespace platoon
