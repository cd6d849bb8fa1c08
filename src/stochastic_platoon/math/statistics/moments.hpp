#pragma once

#include <cstdint>
#include <limits>

#include "stochastic_platoon/math/numerics/vector_clones.hpp"

namespace platoon {

/// Moments kept of a sample. Normal values need two; the standard error of the variance of other values needs the
/// fourth.
enum class KeptMoments { two, four };

/// Count, mean and sum of squared deviations of a sample, which give the mean and the unbiased variance; optionally the
/// sums of the third and fourth powers.
struct Moments {
  std::uint64_t count = 0;
  double mean = 0.0;                                                    ///< [m]
  double squared_deviations = 0.0;                                      ///< sum of (x - mean)^2 [m^2]
  double cubed_deviations = std::numeric_limits<double>::quiet_NaN();   ///< [m^3]; NaN: not kept
  double fourth_deviations = std::numeric_limits<double>::quiet_NaN();  ///< [m^4]; NaN: not kept

  /// The mean [m]; NaN without values.
  double known_mean() const { return count > 0 ? mean : std::numeric_limits<double>::quiet_NaN(); }

  /// Unbiased variance (n - 1) [m^2]; NaN for fewer than two values.
  double variance() const;

  /// Adds one value (Welford, 1962).
  void add(double value);
};

/// Mean and sum of squared deviations of the union of two samples of n values each, with half_count = n / 2 (Chan,
/// Golub and LeVeque, 1983, for equal counts: M = M_left + M_right + (mean_right - mean_left)^2 n / 2).
PLATOON_INLINE void merge_equal(double left_mean, double left_deviations, double right_mean, double right_deviations,
                                double half_count, double* mean, double* squared_deviations) {
  const double shift = right_mean - left_mean;
  *mean = 0.5 * (left_mean + right_mean);
  *squared_deviations = (left_deviations + right_deviations) + (shift * shift) * half_count;
}

/// Sums of a sample's deviations from its mean: squares, cubes and fourth powers.
struct Deviations {
  double squared, cubed, fourth;
};

/// The same for the third and fourth powers (P. Pebay, Formulas for robust, one-pass parallel computation of
/// covariances and arbitrary-order statistical moments, SAND2008-6212, for equal counts n, shift =
/// mean_right - mean_left): M3 = M3_left + M3_right + 3/2 shift (M2_right - M2_left),
/// M4 = M4_left + M4_right + shift^4 n / 8 + 3/2 shift^2 (M2_left + M2_right) + 2 shift (M3_right - M3_left).
PLATOON_INLINE void merge_equal_powers(double shift, const Deviations& left, const Deviations& right, double half_count,
                                       double* cubed, double* fourth) {
  const double square = shift * shift;
  *cubed = (left.cubed + right.cubed) + (1.5 * shift) * (right.squared - left.squared);
  *fourth = ((left.fourth + right.fourth) + (square * square) * (0.25 * half_count)) +
            ((1.5 * square) * (left.squared + right.squared) + (2.0 * shift) * (right.cubed - left.cubed));
}

/// Moments of the union of two disjoint samples (Chan, Golub and LeVeque, 1983; Pebay, 2008). An empty sample changes
/// nothing.
Moments merge(const Moments& left, const Moments& right);

/// Standard deviation of the mean of n values of this variance, worth n share independent ones [m].
double standard_error_of_mean(double variance, std::uint64_t count, double share = 1.0);

/// Standard deviation of the unbiased variance of n normal values, with n - 1 of them worth (n - 1) share independent
/// ones: variance sqrt(2 / ((n - 1) share)) [m^2].
double standard_error_of_variance(double variance, std::uint64_t count, double share = 1.0);

/// Standard deviation of the unbiased variance of values of any distribution [m^2], from their measured fourth moment
/// m_4: sqrt((m_4 - v^2 (n - 3) / (n - 1)) / n). NaN for fewer than two values, or if the fourth moment was not kept.
double standard_error_of_variance(const Moments& measured);

}  // namespace platoon
