#pragma once

#include <limits>

namespace platoon {

constexpr double kInfinity = std::numeric_limits<double>::infinity();  ///< no bound
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();      ///< undefined or unknown

}  // namespace platoon
