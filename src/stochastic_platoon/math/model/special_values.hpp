#pragma once

#include <limits>

namespace platoon {

constexpr double kInfinity = std::numeric_limits<double>::infinity();  ///< what has no bound
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();      ///< what is not defined, or not known

}  // namespace platoon
