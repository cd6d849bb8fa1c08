#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>

#include "stochastic_platoon/math/statistics/moments.hpp"

namespace platoon {

/// Deviation of a measured mean and variance from the theory, as scores of a standard normal variable with the same
/// tail probability.
struct Scores {
  double mean;
  double variance;
};

/// Number of independent values that one of n correlated values of variance v is worth: their mean has variance v / (n
/// mean), their unbiased variance has variance 2 v^2 / ((n - 1) variance) and mean v expected.
struct IndependentShare {
  double mean = 1.0;
  double variance = 1.0;
  double expected = 1.0;
};

/// Measured values and their theory.
struct Comparison {
  Moments measured;
  double theoretical_mean;      ///< [m]
  double theoretical_variance;  ///< [m^2]
  double rounding = 0.0;        ///< [m], largest rounding error of a value
  IndependentShare share = {};
  double fourth_moment = std::numeric_limits<double>::quiet_NaN();  ///< [m^4], of the theory
};

/// Scores of n values with this theoretical mean [m] and variance v [m^2], exact for every n. The tracking errors are
/// normal, as they are linear in normal noise and initial positions, and v is known. Thus (mean - theory) / sqrt(v / n)
/// is standard normal (Student's distribution applies to an estimated v), and (n - 1) variance / v has the chi-squared
/// distribution with n - 1 degrees of freedom. The score has the same tail probability for a normal; for large n it
/// tends to (variance - theory) / (v sqrt(2 / (n - 1))).
///
/// If the fourth moment was kept, as for errors that are not normal, the score of the variance is its distance over the
/// measured standard error sqrt((m_4 - v^2) / n), and both scores hold for large n.
///
/// If `fourth_moment` m_4 is given, the values may have any distribution with this fourth moment, however skewed,
/// and any number n. With d = x - mean of the theory, or d = (x - mean)^2 - v, D = E d^2, which is v or m_4 - v^2, and
/// y = (sum d^2 + 2 n D) / 3,
///
///     P((sum d)^2 / (y + b) > 2 ln(1 / a) + ln((y + b) / b)) <= a    for every b > 0,
///
/// as E exp(l sum d - l^2 y / 2) <= 1 for every l (B. Delyon, Electronic J. Probability 14, 2009), averaged over normal
/// l of variance 1 / b (V. de la Pena, M. Klass, T. L. Lai, Annals of Probability 32, 2004). The measured sum d^2 keeps
/// a rare event in the sample from counting too much, and the known D keeps a missing rare event from counting too
/// little. With b = n D / 32 the score is the root of (33 / 32) ((sum d)^2 / (y + b) - ln((y + b) / (33 b))): a
/// distance in standard errors if sum d^2 is near n D. Its bound is plausible_score_of_any(). With an infinite
/// m_4 the variance has no score.
///
/// `rounding` bounds the rounding error of one value. Deviations of the mean and of the standard deviation up to it
/// count as zero; beyond it a score is infinite if v = 0. A score is NaN if one of its values is; that of the variance
/// also for fewer than two values.
///
/// The mean of n correlated values is normal and counts as that of n share.mean values. Their variance over v
/// share.expected counts as chi-squared with as many degrees of freedom as match its own variance, (n - 1)
/// share.variance share.expected^2, which holds if these are many (R. B. Blackman, J. W. Tukey, The Measurement of
/// Power Spectra, 1958).
Scores scores(const Comparison& of);

/// The largest scores in modulus over many cells, and their plausible limit.
struct Agreement {
  double max_abs_z_mean = 0.0;
  double max_abs_z_variance = 0.0;
  double plausible_z = 0.0;  ///< measurement and theory disagree beyond it
  bool means_only = false;   ///< no variance was compared: its score is NaN

  bool agrees() const { return max_abs_z_mean <= plausible_z && (means_only || max_abs_z_variance <= plausible_z); }
  double largest() const { return means_only ? max_abs_z_mean : std::max(max_abs_z_mean, max_abs_z_variance); }
};

/// Finds the agreement of many cells, one after the other.
class LargestScores {
public:
  void add(const Comparison& of);

  /// Compares the means alone, of values of any distribution: the inequality above needs no fourth moment for them.
  void add_mean(const Comparison& of);

  /// Of means only if all cells came by add_mean().
  Agreement agreement() const;

private:
  double mean_ = 0.0, variance_ = 0.0;
  std::size_t comparisons_ = 0;
  bool means_only_ = true;
  bool is_of_any_ = false;  ///< a cell has a fourth moment

  // The score grows with the ratio of the variances, so among successive cells of equal degrees of freedom only ratios
  // beyond all earlier ones matter.
  double freedom_ = 0.0;
  double lowest_ = std::numeric_limits<double>::infinity(), highest_ = -std::numeric_limits<double>::infinity();
};

/// The score that the largest of `comparisons` scores, however dependent, exceeds in modulus with probability at most
/// 0.001 (Bonferroni). A larger score means that measurement and theory disagree.
double largest_plausible_score(std::size_t comparisons);

/// The same for scores with a fourth moment, from their inequality, so the actual probability is lower.
double plausible_score_of_any(std::size_t comparisons);

/// Number of values of this variance and fourth moment needed to distinguish, by `comparisons` comparisons with a
/// fourth moment, a variance of zero from the theoretical one; with fewer values a verdict is meaningless. Infinite if
/// a moment leaves the range of double.
double values_needed(double variance, double fourth_moment, std::size_t comparisons);

}  // namespace platoon
