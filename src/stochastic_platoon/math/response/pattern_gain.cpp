#include "stochastic_platoon/math/response/pattern_gain.hpp"

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "stochastic_platoon/math/numerics/circle_polynomial.hpp"
#include "stochastic_platoon/math/numerics/delta_form.hpp"
#include "stochastic_platoon/math/numerics/quadrature.hpp"

namespace platoon {

namespace {

constexpr int kMostZeros = 8;
constexpr double kExact =
    static_cast<double>(std::numeric_limits<long double>::epsilon()) / std::numeric_limits<double>::epsilon();

std::vector<GainFactor> plain(const std::vector<RatedFactor>& factors) {
  std::vector<GainFactor> result;
  result.reserve(2 * factors.size());
  for (const RatedFactor& factor : factors) {
    result.push_back(factor.factor);
    result.push_back(factor.exact);
    result.back().count = factor.factor.count;
  }
  return result;
}

/// Change of ln |1 - u t|, u = -2 (1 + s) / s^2, over t^order by a relative change of the pole or zero s by 1.
double spread(std::complex<double> s, double t, int order) {
  const std::complex<double> u = -2.0 * (1.0 + s) / (s * s);
  const double reach = std::abs(u) * t;
  if (order > 0 && reach < 0.5) return 2.0 * order * std::pow(std::abs(u), order);
  return reach / std::abs(1.0 - u * t) / std::pow(t, order);
}

double frequency_of(long double t) {
  return t <= 1.0L ? frequency_at(t, Centre::kOne) : frequency_at(2.0L - t, Centre::kMinusOne);
}

}  // namespace

RatedFactor rated_factor(const ClosedLoop& loop) {
  RatedFactor result{{poles_of(loop), zeros_of(loop)}, {}};
  if (loop.parts) return result;
  const DeltaFraction transfer = delta_fraction(loop);
  if (loop.given) {
    result.given = std::make_shared<const RealizationRounding>(loop.realization, *loop.given);
    result.gain_at_one = std::abs(transfer.numerator.front() / transfer.denominator.front());
  } else {
    result.rounded = {z_form(transfer.denominator), z_form(transfer.numerator)};
  }
  return result;
}

// A coefficient that the rounding of given A, B and C could make zero counts as zero if it is small beside its terms:
// by design, as it hardly is by chance. Otherwise it leaves the sign of the margin open.
PatternGain::PatternGain(std::vector<RatedFactor> factors)
    : factors_(std::move(factors)), attenuation_(plain(factors_)) {
  constexpr double kByDesign = 1e-12;
  const auto counts_as_zero = [this](long double coefficient) {
    const double open = std::min(rounding_of_entries(0.0), kByDesign * spread_of_places(0.0));
    return std::abs(coefficient) <= rounding(0.0) + open;
  };
  while (zeros_ < kMostZeros && counts_as_zero(attenuation_.coefficient(zeros_))) ++zeros_;
}

double PatternGain::spread_of_places(double frequency) const {
  const auto t = static_cast<double>(circle_coordinate(frequency, Centre::kOne));
  const int order = nearest(frequency) == Centre::kOne ? zeros_ : 0;
  double sum = 0.0;
  for (const RatedFactor& factor : factors_) {
    double spread_of_factor = 0.0;
    const std::pair<const GainFactor*, double> parts[] = {{&factor.factor, 1.0}, {&factor.exact, kExact}};
    for (const auto& [part, accuracy] : parts) {
      for (const auto* places : {&part->poles, &part->zeros}) {
        for (const std::complex<long double>& s : *places)
          spread_of_factor += accuracy * spread(std::complex<double>(s), t, order);
      }
    }
    sum += static_cast<double>(factor.factor.count) * spread_of_factor;
  }
  return sum;
}

double PatternGain::rounding(double frequency) const {
  // A change of a coefficient c_k that keeps T(1) = 1 moves the polynomial by c_k (z^k - 1 - ...), bounded by powers of
  // k t and by 1.
  const std::complex<double> z = std::polar(1.0, frequency);
  const auto t = static_cast<double>(circle_coordinate(frequency, Centre::kOne));
  const bool near = nearest(frequency) == Centre::kOne;
  double sum = spread_of_places(frequency);
  for (const RatedFactor& factor : factors_) {
    for (const Polynomial& p : factor.rounded) {
      double spread = 0.0;
      for (Eigen::Index i = 0; i < p.size(); ++i) {
        const auto power = static_cast<double>(std::max<Eigen::Index>(p.size() - 1 - i, 1));
        const double divided = t > 0.0 ? std::min(power * power, 1.0 / t) : power * power;
        spread += std::abs(p(i)) * (near ? std::pow(divided, zeros_) : 1.0);
      }
      sum += static_cast<double>(factor.factor.count) * spread / std::abs(evaluate(p, z));
    }
  }
  return kCoefficientRounding * sum;
}

double PatternGain::rounding_of_entries(double frequency) const {
  const bool near = nearest(frequency) == Centre::kOne;
  // The quotient hardly changes where the series converges fast, but its terms cancel at w = 0.
  const long double t = std::max(circle_coordinate(frequency, Centre::kOne), attenuation_.series_end());
  const CirclePoint point(near ? frequency_at(t, Centre::kOne) : frequency);
  double sum = 0.0;
  for (const RatedFactor& factor : factors_) {
    if (factor.given) sum += static_cast<double>(factor.factor.count) * factor.given->at(point);
  }
  return near ? 2.0 * sum / std::pow(static_cast<double>(t), zeros_) : sum;
}

LeastMargin PatternGain::least(double accuracy) const {
  if (attenuation_.is_zero()) return {Sign::kZero, 0.0, 0.0};
  const Attenuation::Minimum found = attenuation_.least(zeros_, accuracy);
  const double w = frequency_of(found.t);
  const auto value = static_cast<double>(found.value);
  const double rounding = doubt(w), margin = value - rounding;
  if (value < -rounding) return {Sign::kBelow, margin, w};
  if (margin > 0.0 && found.is_global) return {Sign::kAbove, margin, w};
  return {Sign::kZero, std::min(margin, 0.0), w};
}

PatternGain::Peak PatternGain::peak() const {
  if (attenuation_.is_zero()) return {0.0, 0.0};
  const Attenuation::Minimum found = attenuation_.least(0);
  if (!(found.value < 0.0L)) return {0.0, 0.0};
  long double logarithm = -found.value / 2.0L;
  for (const RatedFactor& factor : factors_) logarithm += factor.factor.count * std::log(factor.gain_at_one);
  if (!(logarithm > 0.0L)) logarithm = -found.value / 2.0L;
  return {static_cast<double>(std::expm1(logarithm)), frequency_of(found.t)};
}

std::vector<double> PatternGain::maxima() const {
  std::vector<std::complex<double>> singular;
  for (const RatedFactor& factor : factors_) {
    for (const auto* poles : {&factor.factor.poles, &factor.exact.poles}) {
      for (const std::complex<double>& w : frequencies_of(*poles)) singular.push_back(w);
    }
  }
  // The nodes resolve every factor except where it is small: between two of them the slope turns at most once.
  std::vector<long double> nodes = half_circle_quadrature(singular, {}).node;
  nodes.insert(nodes.begin(), 0.0L);
  const double pi = frequency_of(2.0L);
  nodes.push_back(pi);
  std::vector<double> found{pi};
  const auto slope = [this](long double t) { return attenuation_.slope(t); };
  const auto close = [](long double a, long double b) { return b - a <= 1e-15L * b; };
  long double from = 0.0L, before = slope(from);
  for (std::size_t k = 1; k < nodes.size(); ++k) {
    const long double to = circle_coordinate(nodes[k], Centre::kOne), behind = slope(to);
    if (before < 0.0L && !(behind < 0.0L)) {
      std::uintmax_t evaluations = 100;
      found.push_back(
          frequency_of(boost::math::tools::toms748_solve(slope, from, to, before, behind, close, evaluations).second));
    }
    from = to;
    before = behind;
  }
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<std::complex<double>> PatternGain::margin_frequencies() const {
  constexpr double kWide = 0.5;  // panels are never longer
  std::vector<std::complex<double>> frequencies;
  // Near w = 0: c t^n + c' t^(n+1) is 0 at t = -c / c'.
  const long double first = attenuation_.coefficient(zeros_), second = attenuation_.coefficient(zeros_ + 1);
  if (first > 0.0L && second > 0.0L) {
    const auto width = static_cast<double>(std::sqrt(2.0L * first / second));
    if (width < kWide) frequencies.emplace_back(0.0, width);
  }
  for (const double w : maxima()) {
    const long double t = circle_coordinate(w, Centre::kOne);
    const Attenuation::Value a = attenuation_.at(t);
    // a(w) ~ value + curvature (dt/dw)^2 / 2 x^2 + slope d^2t/dw^2 / 2 x^2
    const long double sine = std::sin(static_cast<long double>(w));
    const long double bend = a.curvature * sine * sine + a.slope * (1.0L - t);
    if (!(a.value > 0.0L && bend > 0.0L)) continue;
    const auto width = static_cast<double>(std::sqrt(2.0L * a.value / bend));
    if (width < kWide && width > 1e-12) frequencies.emplace_back(w, width);
  }
  return frequencies;
}

}  // namespace platoon
