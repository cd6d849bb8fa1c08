#pragma once

#include <vector>

#include "stochastic_platoon/math/statistics/moments.hpp"

namespace platoon {

/// All four moments of a sample by two passes in extended precision: the mean, then the deviations from it.
inline Moments two_pass_moments(const std::vector<double>& values) {
  long double sum = 0.0L, squared = 0.0L, cubed = 0.0L, fourth = 0.0L;
  for (const double value : values) sum += value;
  const long double mean = sum / static_cast<long double>(values.size());
  for (const double value : values) {
    const long double d = value - mean;
    squared += d * d;
    cubed += d * d * d;
    fourth += d * d * d * d;
  }
  return {values.size(), static_cast<double>(mean), static_cast<double>(squared), static_cast<double>(cubed),
          static_cast<double>(fourth)};
}

}  // namespace platoon
