#include "stochastic_platoon/math/statistics/agreement.hpp"

#include <algorithm>
#include <boost/math/special_functions/erf.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>

#include "stochastic_platoon/math/numerics/special_values.hpp"

namespace platoon {

namespace {

using Policy = boost::math::policies::policy<boost::math::policies::promote_double<false>>;

/// The z that a standard normal exceeds with this probability, 0 < probability <= 1/2.
double normal_score(double probability) {
  return std::sqrt(2.0) * boost::math::erfc_inv(2.0 * probability, Policy());
}

/// The normal score of a chi-squared variable over its degrees of freedom.
///
/// If the tail probability leaves the range of double, the score follows from the signed root r of the deviance, by r +
/// ln(w / r) / r with w = (ratio - 1) sqrt(freedom / 2) (O. E. Barndorff-Nielsen, Biometrika 73, 1986). Its relative
/// error there is below 1e-3 for one degree of freedom and falls with their number.
double chi_squared_score(double ratio, double freedom) {
  constexpr double kFar = 40.0;  // where every tail is below 1e-290, and gamma_q may overflow
  if (ratio == 0.0) return -kInfinity;
  const bool above = ratio > 1.0;
  const double shape = 0.5 * freedom, distance = ratio - 1.0;
  const double root = std::sqrt(freedom * (distance - std::log(ratio)));
  if (!(root > kFar)) {
    const double tail = above ? boost::math::gamma_q(shape, shape * ratio, Policy())
                              : boost::math::gamma_p(shape, shape * ratio, Policy());
    if (tail >= 0.5) return above ? 0.0 - normal_score(1.0 - tail) : normal_score(1.0 - tail);
    if (tail > 1e-290) return above ? normal_score(tail) : -normal_score(tail);
  }
  const double score = root + std::log(std::abs(distance) * std::sqrt(shape) / root) / root;
  return above ? score : -score;
}

/// The difference moved towards zero by at most the rounding.
double beyond(double difference, double rounding) {
  if (std::abs(difference) <= rounding) return 0.0;
  return difference > 0.0 ? difference - rounding : difference + rounding;
}

double mean_score(const Comparison& of) {
  const double difference = beyond(of.measured.known_mean() - of.theoretical_mean, of.rounding);
  const double variance = of.theoretical_variance;
  if (!(variance >= 0.0)) return kNaN;
  if (variance > 0.0) return difference / standard_error_of_mean(variance, of.measured.count, of.share.mean);
  return difference == 0.0 ? 0.0 : difference * kInfinity;
}

/// The change of a variance by rounding errors e of errors of standard deviation sqrt(v): 2 sqrt(v) e + e^2.
double rounding_of_variance(double variance, double rounding) {
  return rounding * (2.0 * std::sqrt(variance) + rounding);
}

/// The measured variance over the expected one, moved towards 1 by the possible effect of rounding. Infinite or NaN
/// (0 / 0) for a theoretical variance of 0.
double variance_ratio(const Comparison& of) {
  const double measured = of.measured.variance(), variance = of.theoretical_variance * of.share.expected;
  const double allowed = rounding_of_variance(variance, of.rounding);
  if (measured > variance + allowed) return (measured - allowed) / variance;
  if (measured < variance - allowed) return std::max(measured + allowed, 0.0) / variance;
  return variance / variance;
}

constexpr double kPrior = 1.0 / 32.0;  // b over n D

double self_normalized_score(double sum, double squares, double expected_squares) {
  const double y = (squares + 2.0 * expected_squares) / 3.0 + kPrior * expected_squares;
  const double usual = (1.0 + kPrior) * expected_squares;
  const double square = (1.0 + kPrior) * (sum * (sum / y) - std::log(y / usual));
  if (square <= 0.0) return 0.0;  // unlike std::max, keeps NaN
  return std::copysign(std::sqrt(square), sum);
}

/// Whether the scores are those for any distribution. Without randomness the exact scores apply.
bool is_of_any(const Comparison& of) {
  return of.theoretical_variance > 0.0 && !std::isnan(of.fourth_moment);
}

// The score of the mean of values of any distribution with the theoretical variance.
double mean_score_of_any(const Comparison& of) {
  if (!(of.theoretical_variance > 0.0)) return mean_score(of);
  const auto n = static_cast<double>(of.measured.count);
  const double shift = of.measured.mean - of.theoretical_mean;
  return self_normalized_score(n * beyond(shift, of.rounding), of.measured.squared_deviations + n * shift * shift,
                               n * of.theoretical_variance);
}

Scores scores_of_any(const Comparison& of) {
  const Moments& measured = of.measured;
  if (measured.count == 0) return {kNaN, kNaN};
  const auto n = static_cast<double>(measured.count);
  const double variance = of.theoretical_variance;
  // Power sums of deviations from the theoretical mean.
  const double shift = measured.mean - of.theoretical_mean, square = shift * shift;
  const double squared = measured.squared_deviations + n * square;
  const double fourth = measured.fourth_deviations + 4.0 * shift * measured.cubed_deviations +
                        6.0 * square * measured.squared_deviations + n * square * square;
  const double of_mean = mean_score_of_any(of);
  if (measured.count < 2 || std::isinf(of.fourth_moment)) return {of_mean, kNaN};
  const double difference = n * beyond(squared / n - variance, rounding_of_variance(variance, of.rounding));
  const double squares = fourth - 2.0 * variance * squared + n * variance * variance;
  return {of_mean, self_normalized_score(difference, squares, n * (of.fourth_moment - variance * variance))};
}

bool has_variances(const Comparison& of) {
  return std::isfinite(of.measured.variance()) && of.theoretical_variance >= 0.0;
}

// Score for values of any distribution with a measured fourth moment.
double measured_variance_score(const Comparison& of) {
  const double difference = beyond(of.measured.variance() - of.theoretical_variance,
                                   rounding_of_variance(of.theoretical_variance, of.rounding));
  return difference == 0.0 ? 0.0 : difference / standard_error_of_variance(of.measured);
}

double degrees_of_freedom(const Comparison& of) {
  return static_cast<double>(of.measured.count - 1) * of.share.variance * of.share.expected * of.share.expected;
}

double variance_score(const Comparison& of) {
  if (!has_variances(of)) return kNaN;
  if (!std::isnan(of.measured.fourth_deviations)) return measured_variance_score(of);
  const double ratio = variance_ratio(of);
  if (std::isnan(of.share.expected)) return kNaN;
  if (std::isnan(ratio)) return 0.0;
  if (std::isinf(ratio)) return kInfinity;
  if (std::isnan(of.share.variance)) return kNaN;
  return chi_squared_score(ratio, degrees_of_freedom(of));
}

// Raises `worst` to the modulus of the score; NaN remains, which std::max would drop or replace.
void raise_to(double& worst, double score) {
  if (!std::isnan(worst) && !(std::abs(score) <= worst)) worst = std::abs(score);
}

}  // namespace

Scores scores(const Comparison& of) {
  return is_of_any(of) ? scores_of_any(of) : Scores{mean_score(of), variance_score(of)};
}

void LargestScores::add_mean(const Comparison& of) {
  ++comparisons_;
  is_of_any_ = true;
  raise_to(mean_, of.measured.count > 0 ? mean_score_of_any(of) : kNaN);
}

void LargestScores::add(const Comparison& of) {
  if (std::isinf(of.fourth_moment)) return add_mean(of);
  comparisons_ += 2;
  means_only_ = false;
  is_of_any_ = is_of_any_ || !std::isnan(of.fourth_moment);
  const bool is_exact = !is_of_any(of) && std::isnan(of.measured.fourth_deviations);
  if (is_exact && has_variances(of)) {
    const double ratio = variance_ratio(of), freedom = degrees_of_freedom(of);
    if (freedom != freedom_) lowest_ = kInfinity, highest_ = -kInfinity;
    freedom_ = freedom;
    if (ratio >= lowest_ && ratio <= highest_) return raise_to(mean_, mean_score(of));
    lowest_ = std::min(lowest_, ratio);
    highest_ = std::max(highest_, ratio);
  }
  const Scores found = scores(of);
  raise_to(mean_, found.mean);
  raise_to(variance_, found.variance);
}

Agreement LargestScores::agreement() const {
  const double plausible = is_of_any_ ? plausible_score_of_any(comparisons_) : largest_plausible_score(comparisons_);
  const bool means_only = means_only_ && comparisons_ > 0;
  return {mean_, means_only ? kNaN : variance_, plausible, means_only};
}

double largest_plausible_score(std::size_t comparisons) {
  return normal_score(0.0005 / static_cast<double>(std::max<std::size_t>(comparisons, 1)));
}

double plausible_score_of_any(std::size_t comparisons) {
  const double chance = 0.001 / static_cast<double>(std::max<std::size_t>(comparisons, 1));
  return std::sqrt((1.0 + kPrior) * (std::log(1.0 + 1.0 / kPrior) - 2.0 * std::log(chance)));
}

double values_needed(double variance, double fourth_moment, std::size_t comparisons) {
  if (variance == 0.0) return 0.0;
  const double bound = plausible_score_of_any(comparisons);
  const double needed = bound * bound * (fourth_moment / variance / variance - 1.0);
  if (std::isnan(needed)) return kInfinity;
  return needed;
}

}  // namespace platoon
