#include "stochastic_platoon/math/statistics/agreement.hpp"

#include <algorithm>
#include <boost/math/special_functions/erf.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <stdexcept>

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
  const bool above = ratio > 1.0;
  const double shape = 0.5 * freedom;
  const double tail = above ? boost::math::gamma_q(shape, shape * ratio, Policy())
                            : boost::math::gamma_p(shape, shape * ratio, Policy());
  if (tail >= 0.5) return above ? 0.0 - normal_score(1.0 - tail) : normal_score(1.0 - tail);
  if (tail > 1e-290) return above ? normal_score(tail) : -normal_score(tail);
  if (ratio == 0.0) return -kInfinity;
  const double distance = ratio - 1.0;
  const double root = std::sqrt(freedom * (distance - std::log(ratio)));
  const double score = root + std::log(std::abs(distance) * std::sqrt(shape) / root) / root;
  return above ? score : -score;
}

/// The difference moved towards zero by at most the rounding.
double beyond(double difference, double rounding) {
  if (std::abs(difference) <= rounding) return 0.0;
  return difference > 0.0 ? difference - rounding : difference + rounding;
}

double mean_score(const Moments& measured, double mean, double variance, double rounding,
                  const IndependentShare& share = {}) {
  const double difference = beyond(measured.count > 0 ? measured.mean - mean : kNaN, rounding);
  if (!(variance >= 0.0)) return kNaN;
  if (variance > 0.0) return difference / standard_error_of_mean(variance, measured.count, share.mean);
  return difference == 0.0 ? 0.0 : difference * kInfinity;
}

/// The measured variance over the theoretical one, moved towards 1 by the possible effect of rounding: rounding errors
/// e change the variance of errors of standard deviation sqrt(v) by 2 sqrt(v) e + e^2. Infinite or NaN (0 / 0) for a
/// theoretical variance of 0.
double variance_ratio(double measured, double variance, double rounding) {
  const double allowed = rounding * (2.0 * std::sqrt(variance) + rounding);
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
bool is_of_any(double variance, double fourth_moment) {
  return variance > 0.0 && !std::isnan(fourth_moment);
}

Scores scores_of_any(const Moments& measured, double mean, double variance, double rounding, double fourth_moment) {
  if (measured.count == 0) return {kNaN, kNaN};
  const auto n = static_cast<double>(measured.count);
  // Power sums of deviations from the theoretical mean.
  const double shift = measured.mean - mean, square = shift * shift;
  const double squared = measured.squared_deviations + n * square;
  const double fourth = measured.fourth_deviations + 4.0 * shift * measured.cubed_deviations +
                        6.0 * square * measured.squared_deviations + n * square * square;
  const double of_mean = self_normalized_score(n * beyond(shift, rounding), squared, n * variance);
  if (measured.count < 2) return {of_mean, kNaN};
  const double difference = n * beyond(squared / n - variance, rounding * (2.0 * std::sqrt(variance) + rounding));
  const double squares = fourth - 2.0 * variance * squared + n * variance * variance;
  return {of_mean, self_normalized_score(difference, squares, n * (fourth_moment - variance * variance))};
}

bool is_judged(double measured, double variance) {
  return std::isfinite(measured) && variance >= 0.0;
}

// Score for values of any distribution with a measured fourth moment.
double measured_variance_score(const Moments& measured, double variance, double rounding) {
  const double difference = beyond(measured.variance() - variance, rounding * (2.0 * std::sqrt(variance) + rounding));
  return difference == 0.0 ? 0.0 : difference / standard_error_of_variance(measured);
}

double degrees_of_freedom(const Moments& measured, const IndependentShare& share) {
  return static_cast<double>(measured.count - 1) * share.variance * share.expected * share.expected;
}

double variance_score(const Moments& measured, double variance, double rounding, const IndependentShare& share = {}) {
  if (!is_judged(measured.variance(), variance)) return kNaN;
  if (!std::isnan(measured.fourth_deviations)) return measured_variance_score(measured, variance, rounding);
  const double ratio = variance_ratio(measured.variance(), variance * share.expected, rounding);
  if (std::isnan(share.expected)) return kNaN;
  if (std::isnan(ratio)) return 0.0;
  if (std::isinf(ratio)) return kInfinity;
  if (std::isnan(share.variance)) return kNaN;
  return chi_squared_score(ratio, degrees_of_freedom(measured, share));
}

// The larger value, or NaN if either is: std::max would drop or replace NaN.
double larger(double worst, double next) {
  return std::isnan(worst) || next <= worst ? worst : next;
}

}  // namespace

Scores scores(const Moments& measured, double theoretical_mean, double theoretical_variance, double rounding,
              const IndependentShare& share, double fourth_moment) {
  if (is_of_any(theoretical_variance, fourth_moment))
    return scores_of_any(measured, theoretical_mean, theoretical_variance, rounding, fourth_moment);
  return {mean_score(measured, theoretical_mean, theoretical_variance, rounding, share),
          variance_score(measured, theoretical_variance, rounding, share)};
}

Agreement agreement(const std::vector<Moments>& measured, const std::vector<double>& theoretical_mean,
                    const std::vector<double>& theoretical_variance, const std::vector<double>& rounding,
                    const std::vector<IndependentShare>& share, const std::vector<double>& fourth_moment) {
  if (measured.size() != theoretical_mean.size() || measured.size() != theoretical_variance.size() ||
      (!rounding.empty() && measured.size() != rounding.size()) ||
      (!share.empty() && measured.size() != share.size()) ||
      (!fourth_moment.empty() && measured.size() != fourth_moment.size())) {
    throw std::invalid_argument("measurement and theory must have the same number of cells");
  }
  Agreement worst;
  worst.plausible_z = fourth_moment.empty() ? largest_plausible_score(2 * measured.size())
                                            : plausible_score_of_any(2 * measured.size());
  // The score grows with the ratio, so among cells of equal degrees of freedom only ratios beyond all earlier ones
  // matter.
  double freedom = 0.0;
  double lowest = kInfinity, highest = -kInfinity;
  for (std::size_t c = 0; c < measured.size(); ++c) {
    const double allowed = rounding.empty() ? 0.0 : rounding[c];
    if (!fourth_moment.empty() && is_of_any(theoretical_variance[c], fourth_moment[c])) {
      const Scores found =
          scores_of_any(measured[c], theoretical_mean[c], theoretical_variance[c], allowed, fourth_moment[c]);
      worst.max_abs_z_mean = larger(worst.max_abs_z_mean, std::abs(found.mean));
      worst.max_abs_z_variance = larger(worst.max_abs_z_variance, std::abs(found.variance));
      continue;
    }
    const IndependentShare of = share.empty() ? IndependentShare{} : share[c];
    const double mean = mean_score(measured[c], theoretical_mean[c], theoretical_variance[c], allowed, of);
    worst.max_abs_z_mean = larger(worst.max_abs_z_mean, std::abs(mean));
    if (std::isnan(measured[c].fourth_deviations) && is_judged(measured[c].variance(), theoretical_variance[c])) {
      const double ratio = variance_ratio(measured[c].variance(), theoretical_variance[c] * of.expected, allowed);
      const double freedom_here = degrees_of_freedom(measured[c], of);
      if (freedom_here != freedom) lowest = kInfinity, highest = -kInfinity;
      freedom = freedom_here;
      if (ratio >= lowest && ratio <= highest) continue;
      lowest = std::min(lowest, ratio);
      highest = std::max(highest, ratio);
    }
    const double variance = variance_score(measured[c], theoretical_variance[c], allowed, of);
    worst.max_abs_z_variance = larger(worst.max_abs_z_variance, std::abs(variance));
  }
  return worst;
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
  return std::isnan(needed) ? kInfinity : needed;
}

}  // namespace platoon
