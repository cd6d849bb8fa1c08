#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "stochastic_platoon/math/statistics/moments.hpp"

namespace platoon {

/// How far a measured mean and variance lie from the theory, as scores of a standard normal: each has the
/// probability, beyond it on its side, that an estimate has that lies as far off.
struct Scores {
  double mean;
  double variance;
};

/// What one of several correlated values is worth, in independent ones, for their mean and for their variance, and the
/// mean of their unbiased variance over what it is of independent ones.
struct IndependentShare {
  double mean = 1.0;
  double variance = 1.0;
  double expected = 1.0;
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
/// Where `fourth_moment` m_4 [m^4] is given, the values may have any distribution with it, however skewed, and any
/// number n of them: with d = x - mean of the theory, or d = (x - mean)^2 - v, D = E d^2, which is v or m_4 - v^2, and
/// y = (sum d^2 + 2 n D) / 3,
///     P((sum d)^2 / (y + b) > 2 ln(1 / a) + ln((y + b) / b)) <= a    for every b > 0,
/// as E exp(l sum d - l^2 y / 2) <= 1 for every l (B. Delyon, Electronic J. Probability 14, 2009), averaged over normal
/// l of variance 1 / b (V. de la Pena, M. Klass, T. L. Lai, Annals of Probability 32, 2004). What is measured, sum d^2,
/// does not make much of a rare event that is among the values, and what is known, D, not little of one that is not.
/// With b = n D / 32 the score is the root of (33 / 32) ((sum d)^2 / (y + b) - ln((y + b) / (33 b))): a distance in
/// standard errors where sum d^2 is near n D. Its bound is plausible_score_of_any().
///
/// `rounding` [m] bounds what the arithmetic may add to one error: a mean within it, and a standard deviation
/// within it, count as equal to the theory. Beyond it a score is infinite where v = 0. NaN where a value is,
/// and for the variance of fewer than two values.
///
/// Of n correlated values the mean is normal and counts for n share.mean; their variance, over v share.expected, counts
/// as chi-squared with as many degrees of freedom as give it its own variance, (n - 1) share.variance share.expected^2,
/// which holds where these are many (R. B. Blackman, J. W. Tukey, The Measurement of Power Spectra, 1958).
Scores scores(const Moments& measured, double theoretical_mean, double theoretical_variance, double rounding = 0.0,
              const IndependentShare& share = {}, double fourth_moment = std::numeric_limits<double>::quiet_NaN());

/// The largest scores in modulus over many cells, and what they may be by chance.
struct Agreement {
  double max_abs_z_mean = 0.0;
  double max_abs_z_variance = 0.0;
  double plausible_z = 0.0;  ///< beyond it measurement and theory disagree

  bool agrees() const { return max_abs_z_mean <= plausible_z && max_abs_z_variance <= plausible_z; }
};

/// `rounding` [m], `share` and `fourth_moment` [m^4] have one value per cell, or are empty for none, for independent
/// values, and for normal ones. Throws std::invalid_argument when the sizes differ.
Agreement agreement(const std::vector<Moments>& measured, const std::vector<double>& theoretical_mean,
                    const std::vector<double>& theoretical_variance, const std::vector<double>& rounding = {},
                    const std::vector<IndependentShare>& share = {}, const std::vector<double>& fourth_moment = {});

/// The score that the largest of `comparisons` scores, however they depend on each other, exceeds in modulus
/// with probability of at most 0.001 (Bonferroni): beyond it measurement and theory disagree.
double largest_plausible_score(std::size_t comparisons);

/// The same of scores with a fourth moment. By the inequality that they are made from, so that chance exceeds it less
/// often than that.
double plausible_score_of_any(std::size_t comparisons);

/// How many values of this variance and fourth moment it takes to tell, by so many comparisons with a fourth moment, a
/// variance of nothing from the theoretical one: with fewer, no verdict is worth its name. Infinite where a moment
/// leaves the range of double.
double values_needed(double variance, double fourth_moment, std::size_t comparisons);

}  // namespace platoon
