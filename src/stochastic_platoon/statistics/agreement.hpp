#pragma once

#include <cstddef>
#include <vector>

#include "stochastic_platoon/statistics/moments.hpp"

namespace platoon {

/// How far a measured mean and variance lie from the theory, as scores of a standard normal: each has the
/// probability, beyond it on its side, that an estimate has that lies as far off.
struct Scores {
  double mean;
  double variance;
};

/// What one of several correlated values is worth, in independent ones, for their mean and for their variance.
struct IndependentShare {
  double mean = 1.0;
  double variance = 1.0;
};

/// Scores of n values with this theoretical mean [m] and variance v [m^2], exact for every n: the tracking
/// errors are normal, as they are linear in normal noise and initial positions, and v is known, so that
/// (mean - theory) / sqrt(v / n) is standard normal (Student's distribution is for a v that is estimated) and
/// (n - 1) variance / v has the chi-squared distribution with n - 1 degrees of freedom. Its tail probability
/// is given as that of a normal; for large n this tends to (variance - theory) / (v sqrt(2 / (n - 1))).
///
/// Where the fourth moment was kept, as the errors are not normal, the score of the variance is its distance
/// over the standard error sqrt((m_4 - v^2) / n) that was measured, and both hold for large n.
///
/// `rounding` [m] bounds what the arithmetic may add to one error: a mean within it, and a standard deviation
/// within it, count as equal to the theory. Beyond it a score is infinite where v = 0. NaN where a value is,
/// and for the variance of fewer than two values.
///
/// Of correlated values n counts for n share.mean, and n - 1 degrees of freedom for (n - 1) share.variance, which
/// holds for large n (equivalent degrees of freedom; R. B. Blackman, J. W. Tukey, The Measurement of Power Spectra, 1958).
Scores scores(const Moments& measured, double theoretical_mean, double theoretical_variance,
              double rounding = 0.0, const IndependentShare& share = {});

/// The largest scores in modulus over many cells.
struct Agreement {
  double max_abs_z_mean = 0.0;
  double max_abs_z_variance = 0.0;
};

/// `rounding` [m] and `share` have one value per cell, or are empty for none and for independent values. Throws std::invalid_argument when the sizes
/// differ.
Agreement agreement(const std::vector<Moments>& measured, const std::vector<double>& theoretical_mean,
                    const std::vector<double>& theoretical_variance, const std::vector<double>& rounding = {},
                    const std::vector<IndependentShare>& share = {});

/// The score that the largest of `comparisons` scores, however they depend on each other, exceeds in modulus
/// with probability of at most 0.001 (Bonferroni): beyond it measurement and theory disagree.
double largest_plausible_score(std::size_t comparisons);

}  // namespace platoon
