#include "stochastic_platoon/math/string/critical_delay.hpp"

#include <algorithm>
#include <boost/math/constants/constants.hpp>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <complex>
#include <cstddef>
#include <vector>

#include "stochastic_platoon/math/links/linked_pattern.hpp"
#include "stochastic_platoon/math/model/exact_transfer.hpp"
#include "stochastic_platoon/math/numerics/circle_polynomial.hpp"
#include "stochastic_platoon/math/numerics/interruption.hpp"
#include "stochastic_platoon/math/numerics/special_values.hpp"

namespace platoon {

namespace {

using Complex = std::complex<long double>;

constexpr long double kHalfTurn = boost::math::constants::pi<long double>();

/// The smallest delay of the radio, from one step on, at which |T^| = 1 at a frequency.
class DelayAtFrequency {
public:
  explicit DelayAtFrequency(const VehicleModel& vehicle)
      : filtered_(vehicle.design->headway_filter),
        headway_(vehicle.headway),
        gain_(vehicle.radio()->gain),
        position_delay_(static_cast<long double>(vehicle.position().link.delay)) {
    const ExactTransfer &plant = vehicle.design->plant.exact(), &controller = vehicle.design->controller.exact();
    ExactPolynomial denominator = multiply(plant.denominator, controller.denominator);
    if (vehicle.design->divide_by_one_plus_headway) {
      for (Exact& coefficient : denominator) coefficient *= Exact(1) + Exact(vehicle.headway);
    }
    numerator_ = rounded_delta(multiply(plant.numerator, controller.numerator));
    denominator_ = rounded_delta(denominator);
    delay_ = static_cast<long double>(plant.delay + controller.delay);
  }

  /// Infinite if no delay makes |T^| = 1 there.
  double operator()(double frequency) const {
    const CirclePoint point(frequency);
    const long double w = frequency;
    const Complex s = point.from_one();
    const Complex policy = Complex(1.0L + headway_) - headway_ * std::conj(1.0L + s);
    const Complex n = evaluate(numerator_, s) * std::polar(1.0L, -delay_ * w), d = evaluate(denominator_, s);
    const long double closed = filtered_ ? std::norm(policy * (d + n)) : std::norm(d + policy * n);
    const long double of_radio = gain_ * gain_ * std::norm(d);
    const long double cosine = (closed - std::norm(n) - of_radio) / (2.0L * std::sqrt(of_radio * std::norm(n)));
    if (!(cosine < 1.0L)) return kInfinity;
    const long double half =
        cosine <= -1.0L ? kHalfTurn : std::acos(cosine);  // |T^| > 1 while the angle is within +-half
    const long double angle = std::remainder(
        std::arg(n / d) - (gain_ < 0.0L ? kHalfTurn : 0.0L) + (1.0L - position_delay_) * w, 2.0L * kHalfTurn);
    if (std::abs(angle) <= half) return 1.0;
    const long double turn = angle < -half ? -half - angle : 2.0L * kHalfTurn - half - angle;
    return static_cast<double>(1.0L + turn / w);
  }

private:
  bool filtered_;
  long double headway_, gain_, position_delay_, delay_;
  CirclePolynomial numerator_, denominator_;
};

/// Ascending frequencies: several per turn of the longest delay of interest, and dense towards w = 0.
std::vector<double> places() {
  constexpr double kFirst = 1e-6, kRatio = 1.005, kStep = 0.002;
  std::vector<double> found;
  double w = kFirst;
  for (; w < static_cast<double>(kHalfTurn); w = std::min(w * kRatio, w + kStep)) found.push_back(w);
  found.push_back(static_cast<double>(kHalfTurn));
  return found;
}

double smallest_delay(const DelayAtFrequency& delay_at) {
  constexpr int kBits = 40;
  const std::vector<double> frequencies = places();
  std::vector<double> delays;
  delays.reserve(frequencies.size());
  for (const double w : frequencies) delays.push_back(delay_at(w));
  double least = *std::min_element(delays.begin(), delays.end());
  if (std::isinf(least)) return least;
  const double nearby = least * 1.01;  // a local minimum falls by less between two places
  for (std::size_t k = 1; k + 1 < delays.size(); ++k) {
    check_interruption();
    if (!(delays[k] <= nearby && delays[k] <= delays[k - 1] && delays[k] <= delays[k + 1])) continue;
    const auto finite = [&delay_at](double w) { return std::min(delay_at(w), 1e9); };
    const auto found = boost::math::tools::brent_find_minima(finite, frequencies[k - 1], frequencies[k + 1], kBits);
    least = std::min(least, found.second);
  }
  return least;
}

}  // namespace

std::optional<double> critical_delay(const PlatoonModel& model) {
  const VehicleModel& own = model.default_vehicle();
  if (!is_homogeneous(model) || own.radio() == nullptr || own.radio()->gain == 0.0 || !own.design) return std::nullopt;
  const LinkedPattern pattern(model);
  if (pattern.has_losses() || !pattern.mean_square_stable()) return std::nullopt;
  const auto is_stable = [&](double delay) {
    PlatoonModel delayed = model;
    delayed.default_vehicle().radio()->link.delay = static_cast<std::int64_t>(delay);
    return LinkedPattern(delayed, pattern).gain_margin() > 0.0;
  };
  if (!is_stable(1.0)) return std::nullopt;
  constexpr double kConfirmed = 128.0;  // the exact verdict takes the cube of the delay
  const double found = smallest_delay(DelayAtFrequency(own)), whole = std::floor(found);
  if (!(found <= kLongestCriticalDelay)) return std::nullopt;
  if (whole < kConfirmed && (!is_stable(whole) || is_stable(whole + 1.0))) return std::nullopt;
  return found;
}

}  // namespace platoon
