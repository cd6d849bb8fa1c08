#pragma once

#include <limits>
#include <optional>

namespace platoon {

/// The values from lower to upper.
struct Interval {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();

  bool contains(double value) const { return lower <= value && value <= upper; }
};

inline bool operator==(const Interval& one, const Interval& other) {
  return one.lower == other.lower && one.upper == other.upper;
}

/// What a vehicle can do. Each interval contains 0; none: unlimited.
struct VehicleLimits {
  std::optional<Interval> input = {};  ///< of the control input u [m/s^2]
  std::optional<Interval> speed = {};  ///< [m/s]; of vehicles with an actuator_lag() only

  bool any() const { return input || speed; }
};

inline bool operator==(const VehicleLimits& one, const VehicleLimits& other) {
  return one.input == other.input && one.speed == other.speed;
}

}  // namespace platoon
