#pragma once

#include <cmath>
#include <optional>
#include <string>

#include "stochastic_platoon/math/numerics/text.hpp"

namespace platoon {

/// Six digits and the unit, empty for a plain number; "none" for NaN.
inline std::string figure(double value, const std::string& unit) {
  if (std::isnan(value)) return "none";
  if (std::isinf(value)) return "beyond the range of double";
  return formatted("%.6g", value) + (unit.empty() ? "" : " " + unit);
}

/// The same, or "none" without a value.
inline std::string figure(std::optional<double> value, const std::string& unit) {
  return value ? figure(*value, unit) : "none";
}

}  // namespace platoon
