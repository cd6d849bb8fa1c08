#include "stochastic_platoon/math/statistics/normal_crossing.hpp"

#include <algorithm>
#include <boost/math/constants/constants.hpp>
#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/special_functions/erf.hpp>
#include <boost/math/special_functions/owens_t.hpp>
#include <cmath>

#include "stochastic_platoon/math/numerics/special_values.hpp"

namespace platoon {

namespace {

using boost::math::double_constants::pi;

constexpr double kNegligibleExponent = 40.0;  // e^-40 is 4e-18
constexpr double kUnderflow = 745.0;

using Rule = boost::math::quadrature::gauss<double, 20>;

/// Phi(-a).
double above(double a) {
  return 0.5 * std::erfc(a / std::sqrt(2.0));
}

/// Phi(a) - Phi(b) for a > b.
double between(double a, double b) {
  if (a - b < 1.0) {
    const auto density = [](double u) { return std::exp(-0.5 * u * u) / std::sqrt(2.0 * pi); };
    return Rule::integrate(density, b, a);
  }
  return a + b > 0.0 ? above(b) - above(a) : above(-a) - above(-b);
}

/// P(x >= 0, y < 0) by Owen's T, for a b > 0; NaN if its terms cancel. `half`: theta / 2.
double by_owens_t(double a, double b, double half) {
  const double sine = std::sin(half), turn = 2.0 * sine * std::cos(half), from_one = 2.0 * sine * sine;
  const double one = boost::math::owens_t(a, ((b - a) / a + from_one) / turn),
               other = boost::math::owens_t(b, ((a - b) / b + from_one) / turn),
               difference = a > b   ? 0.5 * between(a, b)
                            : a < b ? -0.5 * between(b, a)
                                    : 0.0;
  const double sum = one + other + difference;
  return sum > 0.01 * (std::abs(one) + std::abs(other) + std::abs(difference)) ? sum : kNaN;
}

/// 1/pi times the integral over 0 .. half, in s = ln tan(angle), where the integrand decays with exp(s) and
/// exp(exp(s)).
double crossing_integral(double a, double b, double half) {
  const double apart = (a - b) * (a - b) / 8.0, both = (a + b) * (a + b) / 8.0, end = std::log(std::tan(half));
  const auto exponent = [apart, both](double s) { return apart * std::exp(-2.0 * s) + both * std::exp(2.0 * s); };
  const double peak = apart == 0.0 || both == 0.0 ? end : std::min(0.25 * std::log(apart / both), end);
  const double least = exponent(peak);
  if (!(least + apart + both < kUnderflow)) return 0.0;
  // Only where the integrand is above e^-40 of its largest value, in panels that the rule resolves.
  const double most = least + kNegligibleExponent;
  const double from = std::max(0.5 * std::log(apart / most), peak - kNegligibleExponent),
               to = std::min(end, 0.5 * std::log(most / both));
  const auto value = [&](double s) { return std::exp(least - exponent(s)) / (std::exp(-s) + std::exp(s)); };
  const int panels = static_cast<int>(std::max(std::ceil(2.0 * (to - from)), 4.0));
  const double length = (to - from) / panels;
  double sum = 0.0;
  for (int panel = 0; panel < panels; ++panel)
    sum += Rule::integrate(value, from + panel * length, from + (panel + 1) * length);
  return std::exp(-least - apart - both) * sum / pi;
}

}  // namespace

double probability_below_zero(const NormalLaw& x) {
  if (x.variance == 0.0) return x.mean < 0.0 ? 1.0 : std::isnan(x.mean) ? kNaN : 0.0;
  return above(x.mean / std::sqrt(x.variance));
}

double probability_of_crossing(const NormalLaw& x, const NormalLaw& y, double variance_of_change) {
  if (!std::isfinite(x.variance) || !std::isfinite(y.variance) || std::isnan(x.mean + y.mean)) return kNaN;
  if (x.variance == 0.0) return x.mean >= 0.0 ? probability_below_zero(y) : 0.0;
  if (y.variance == 0.0) return y.mean < 0.0 ? probability_below_zero({-x.mean, x.variance}) : 0.0;
  const double of_x = std::sqrt(x.variance), of_y = std::sqrt(y.variance), a = x.mean / of_x, b = y.mean / of_y;
  // 2 (1 - rho) and 2 (1 + rho), times the product of both deviations
  const double less = variance_of_change - (of_x - of_y) * (of_x - of_y),
               more = (of_x + of_y) * (of_x + of_y) - variance_of_change;
  const double half = std::atan2(std::sqrt(std::max(less, 0.0)), std::sqrt(std::max(more, 0.0)));
  const double jump = a > b ? between(a, b) : 0.0;
  if (half == 0.0) return jump;
  if (a * b > 0.0) {
    const double closed = by_owens_t(a, b, half);
    if (!std::isnan(closed)) return closed;
  }
  return jump + crossing_integral(a, b, half);
}

double mean_needed(double variance, double probability) {
  return std::sqrt(2.0 * variance) * boost::math::erfc_inv(2.0 * probability);
}

}  // namespace platoon
