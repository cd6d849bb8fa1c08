#include "stochastic_platoon/math/statistics/normal_tail.hpp"

#include <boost/math/constants/constants.hpp>
#include <boost/math/special_functions/erf.hpp>
#include <cmath>

namespace platoon {

namespace {

using boost::math::double_constants::root_two;
using boost::math::double_constants::two_pi;

constexpr double kSeriesFrom = 30.0;  // from here on the asymptotic series has all digits

// P(x > a) over the density at a: 1/a - 1/a^3 + 3/a^5 - 15/a^7 + ...
double mills_ratio(double a) {
  const double t = 1.0 / (a * a);
  return (1.0 - t * (1.0 - 3.0 * t * (1.0 - 5.0 * t * (1.0 - 7.0 * t * (1.0 - 9.0 * t))))) / a;
}

double log_density(double a) {
  return -0.5 * a * a - 0.5 * std::log(two_pi);
}

}  // namespace

double log_normal_tail(double a) {
  if (a < -1.0) return std::log1p(-0.5 * std::erfc(-a / root_two));
  if (a < kSeriesFrom) return std::log(0.5 * std::erfc(a / root_two));
  return log_density(a) + std::log(mills_ratio(a));
}

double normal_tail_quantile(double log_probability) {
  if (log_probability > -0.5 * kSeriesFrom * kSeriesFrom)
    return root_two * boost::math::erfc_inv(2.0 * std::exp(log_probability));
  double a = std::sqrt(-2.0 * log_probability);
  for (int i = 0; i < 6; ++i) a += (log_normal_tail(a) - log_probability) * mills_ratio(a);  // Newton's method
  return a;
}

}  // namespace platoon
