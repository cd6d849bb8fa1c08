#pragma once

#include <cstdint>

#include "stochastic_platoon/model/vector_clones.hpp"

namespace platoon {

/// Count, mean and sum of squared deviations of a sample: enough for the mean and the unbiased variance.
struct Moments {
  std::uint64_t count = 0;
  double mean = 0.0;                ///< [m]
  double squared_deviations = 0.0;  ///< sum of (x - mean)^2 [m^2]

  /// Unbiased variance (n - 1) [m^2]; NaN for fewer than two values.
  double variance() const;

  /// Adds one value (Welford, 1962).
  void add(double value);
};

/// Mean and sum of squared deviations of the union of two samples of n values each, with half_count = n / 2
/// (Chan, Golub and LeVeque, 1983, for equal counts: M = M_left + M_right + (mean_right - mean_left)^2 n /
/// 2).
PLATOON_INLINE void merge_equal(double left_mean, double left_deviations, double right_mean,
                                double right_deviations, double half_count, double* mean,
                                double* squared_deviations) {
  const double shift = right_mean - left_mean;
  *mean = 0.5 * (left_mean + right_mean);
  *squared_deviations = (left_deviations + right_deviations) + (shift * shift) * half_count;
}

/// Moments of the union of two disjoint samples (Chan, Golub and LeVeque, 1983). An empty sample changes
/// nothing.
Moments merge(const Moments& left, const Moments& right);

/// Standard deviation of the mean of n independent values of this variance [m].
double standard_error_of_mean(double variance, std::uint64_t count);

/// Standard deviation of the unbiased variance of n independent normal values: variance sqrt(2 / (n - 1))
/// [m^2].
double standard_error_of_variance(double variance, std::uint64_t count);

}  // namespace platoon
