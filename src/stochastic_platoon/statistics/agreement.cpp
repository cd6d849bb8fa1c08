#include "stochastic_platoon/statistics/agreement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace platoon {

namespace {

// Rounding of positions of up to a few hundred metres, summed over a run, against errors of this size.
constexpr double kRounding = 1e-9;

double score(double difference, double standard_error, double scale) {
  if (standard_error > 0.0) return difference / standard_error;
  return std::abs(difference) <= kRounding * (1.0 + std::abs(scale))
             ? 0.0
             : std::numeric_limits<double>::infinity();
}

double larger(double worst, double next) {
  return std::isnan(worst) || next <= worst ? worst : next;
}

}  // namespace

Scores scores(const Moments& measured, double theoretical_mean, double theoretical_variance) {
  const double mean = measured.count > 0 ? measured.mean : std::numeric_limits<double>::quiet_NaN();
  return {score(mean - theoretical_mean, standard_error_of_mean(theoretical_variance, measured.count),
                theoretical_mean),
          score(measured.variance() - theoretical_variance,
                standard_error_of_variance(theoretical_variance, measured.count), theoretical_variance)};
}

Agreement agreement(const std::vector<Moments>& measured, const std::vector<double>& theoretical_mean,
                    const std::vector<double>& theoretical_variance) {
  if (measured.size() != theoretical_mean.size() || measured.size() != theoretical_variance.size()) {
    throw std::invalid_argument("measurement and theory must have the same number of cells");
  }
  Agreement worst;
  for (std::size_t c = 0; c < measured.size(); ++c) {
    const Scores z = scores(measured[c], theoretical_mean[c], theoretical_variance[c]);
    // Not std::max: a NaN must neither be passed over nor replaced.
    worst.max_abs_z_mean = larger(worst.max_abs_z_mean, std::abs(z.mean));
    worst.max_abs_z_variance = larger(worst.max_abs_z_variance, std::abs(z.variance));
  }
  return worst;
}

double largest_plausible_score(std::size_t comparisons) {
  const double tail = 0.001 / static_cast<double>(std::max<std::size_t>(comparisons, 1));
  double low = 0.0, high = 40.0;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (std::erfc(middle / std::sqrt(2.0)) > tail ? low : high) = middle;
  }
  return high;
}

}  // namespace platoon
