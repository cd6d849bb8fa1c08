#include "stochastic_platoon/math/string/critical_delay.hpp"

#include <algorithm>
#include <boost/math/constants/constants.hpp>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <complex>
#include <cstddef>
#include <vector>

#include "stochastic_platoon/math/model/hearing_loop.hpp"
#include "stochastic_platoon/math/numerics/interruption.hpp"
#include "stochastic_platoon/math/numerics/special_values.hpp"
#include "stochastic_platoon/math/string/varied_margins.hpp"

namespace platoon {

namespace {

using Complex = std::complex<long double>;

constexpr long double kHalfTurn = boost::math::constants::pi<long double>();

bool is_of_radio(const Input& input) {
  return input.ahead == 1 && input.signal != InputSignal::position;
}

/// The smallest delay of the radio, from one step on, at which |T^| = 1 at a frequency.
class DelayAtFrequency {
public:
  explicit DelayAtFrequency(const PlatoonModel& model)
      : vehicle_(model.default_vehicle()), period_(model.sample_period), loop_(vehicle_, 2, model.sample_period) {
    for (Input& input : vehicle_.inputs) {
      if (is_of_radio(input)) input.link.delay = 1;
    }
  }

  /// Infinite if no delay makes |T^| = 1 there.
  double operator()(double frequency) const {
    const CirclePoint point(frequency);
    const HearingLoop::Value value = loop_.at(point);
    Complex steady = 0.0L, radio = 0.0L;  // A, and B / z
    for (const Input& input : vehicle_.inputs) {
      if (input.ahead == 1)
        (is_of_radio(input) ? radio : steady) += value.of(input) * sent_value(input, point, value.sent, period_);
    }
    const long double of_steady = std::norm(steady), of_radio = std::norm(radio);
    const long double cosine = (1.0L - of_steady - of_radio) / (2.0L * std::sqrt(of_radio * of_steady));
    if (!(cosine < 1.0L)) return kInfinity;
    const long double half =
        cosine <= -1.0L ? kHalfTurn : std::acos(cosine);  // |T^| > 1 while the angle is within +-half
    const long double angle = std::arg(steady * std::conj(radio));
    if (std::abs(angle) <= half) return 1.0;
    const long double turn = angle < -half ? -half - angle : 2.0L * kHalfTurn - half - angle;
    return static_cast<double>(1.0L + turn / frequency);
  }

private:
  VehicleModel vehicle_;
  double period_;
  HearingLoop loop_;
};

/// Ascending frequencies: several per turn of the longest delay of interest, and dense towards w = 0.
std::vector<double> places() {
  constexpr double kFirst = 1e-6, kGrowth = 1.005, kStep = 0.002;
  std::vector<double> found;
  double w = kFirst;
  for (; w < static_cast<double>(kHalfTurn); w = std::min(w * kGrowth, w + kStep)) found.push_back(w);
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

bool hears_by_radio(const PlatoonModel& model) {
  return std::any_of(model.types.begin(), model.types.end(), [](const VehicleType& type) {
    const std::vector<Input>& inputs = type.vehicle.inputs;
    return std::any_of(inputs.begin(), inputs.end(), is_of_radio);
  });
}

CriticalDelay critical_delay(const PlatoonModel& model) {
  const auto none = [](const char* reason) { return CriticalDelay{std::nullopt, reason}; };
  const VehicleModel& own = model.default_vehicle();
  const auto is_heard = [](const Input& input) { return is_of_radio(input) && input.gain != 0.0; };
  if (!is_homogeneous(model)) return none("the string has several types of vehicles");
  if (!own.design || std::none_of(own.inputs.begin(), own.inputs.end(), is_heard)) return none("there is no radio");
  if (farthest_ahead(model) > 1) return none("a vehicle farther ahead than the predecessor is heard");
  if (loses(model)) return none("a link loses messages");
  const VariedMargins margins = varied_margins(
      [&model](double delay) {
        PlatoonModel delayed = model;
        for (Input& input : delayed.default_vehicle().inputs) {
          if (is_of_radio(input)) input.link.delay = static_cast<std::int64_t>(delay);
        }
        return delayed;
      },
      1.0);
  const auto is_stable = [&](double delay) { return margins.gain(delay) > 0.0; };
  if (!is_stable(1.0)) return none("the string is not stable at a delay of one step");
  constexpr double kConfirmed = 128.0;  // the exact verdict takes the cube of the delay
  const double found = smallest_delay(DelayAtFrequency(model)), whole = std::floor(found);
  if (!(found <= kLongestCriticalDelay)) return none("the string is stable at every delay up to 10000 steps");
  if (whole < kConfirmed && (!is_stable(whole) || is_stable(whole + 1.0)))
    return none("the verdicts beside it are not decided");
  return {found, {}};
}

}  // namespace platoon
