#include "stochastic_platoon/math/response/loop_margins.hpp"

#include <algorithm>
#include <boost/math/constants/constants.hpp>
#include <cmath>
#include <complex>
#include <utility>
#include <vector>

#include "stochastic_platoon/math/model/exact_transfer.hpp"
#include "stochastic_platoon/math/model/hearing_loop.hpp"
#include "stochastic_platoon/math/numerics/circle_polynomial.hpp"
#include "stochastic_platoon/math/numerics/zeros.hpp"
#include "stochastic_platoon/math/response/attenuation.hpp"

namespace platoon {

namespace {

using Complex = std::complex<long double>;

constexpr long double kPi = boost::math::constants::pi<long double>();

ExactTransfer open_loop(const LoopDesign& design, double headway) {
  const ExactTransfer &plant = design.plant.exact(), &controller = design.controller.exact();
  ExactTransfer loop{multiply(plant.numerator, controller.numerator),
                     multiply(plant.denominator, controller.denominator), plant.delay + controller.delay};
  const Exact one_and_headway = Exact(1) + Exact(headway);
  if (design.divide_by_one_plus_headway) {
    for (Exact& coefficient : loop.denominator) coefficient *= one_and_headway;
  }
  if (design.headway_filter) return loop;
  loop.numerator = multiply(loop.numerator, {Exact(1), one_and_headway});  // H = ((1 + h) z - h) / z
  ++loop.delay;
  return loop;
}

/// The frequencies in (0, pi) where |L| crosses 1.
std::vector<double> crossovers(const ExactTransfer& loop) {
  CirclePolynomial numerator = rounded_delta(loop.numerator), denominator = rounded_delta(loop.denominator);
  std::vector<double> found;
  for (const Centre centre : {Centre::kOne, Centre::kMinusOne}) {
    if (centre == Centre::kMinusOne) {
      numerator = recentred(numerator);
      denominator = recentred(denominator);
    }
    const CirclePolynomial excess = subtract(squared_modulus(numerator, centre), squared_modulus(denominator, centre));
    for (const long double t : sign_changes(excess, 0.0L, 1.0L)) found.push_back(frequency_at(t, centre));
    // The halves of the circle meet at t = 1, which belongs to neither of them.
    if (centre == Centre::kOne && evaluate(excess, 1.0L) == 0.0L) found.push_back(frequency_at(1.0L, centre));
  }
  return found;
}

/// arg(-L) in (-pi, pi]: the lag that turns L to -1.
long double lag_to_minus_one(const ExactTransfer& loop, double frequency) {
  const CirclePoint point(frequency);
  const Complex s = point.from_one();
  const Complex undelayed = evaluate(rounded_delta(loop.numerator), s) / evaluate(rounded_delta(loop.denominator), s);
  const long double turned = static_cast<long double>(loop.delay) * static_cast<long double>(frequency);
  return std::arg(-undelayed * std::polar(1.0L, -turned));
}

/// Sets the peak of |1 / (1 + L)| = prod |z - open pole| / prod |z - closed pole|.
void find_peak(std::vector<Complex> closed_poles, const ExactTransfer& loop, LoopMargins& margins) {
  GainFactor sensitivity{std::move(closed_poles), {}};
  long double constant = 0.0L;  // of -ln |1 / (1 + L)|^2
  for (const Complex& pole : sensitivity.poles) constant += std::log(std::norm(pole));
  for (const Complex& zero : zeros(loop.denominator)) {
    if (zero == 0.0L) {
      ++sensitivity.zeros_at_one;
      constant -= std::log(2.0L);  // |z - 1|^2 = 2 t
    } else {
      sensitivity.zeros.push_back(zero);
      constant -= std::log(std::norm(zero));
    }
  }
  const Attenuation::Minimum least = Attenuation({sensitivity}).least(0);
  margins.sensitivity_peak = static_cast<double>(std::exp(-0.5L * (least.value + constant)));
  margins.peak_frequency =
      least.t <= 1.0L ? frequency_at(least.t, Centre::kOne) : frequency_at(2.0L - least.t, Centre::kMinusOne);
}

LoopMargins margins_of(const ExactTransfer& loop, std::vector<Complex> closed_poles) {
  LoopMargins margins{};
  for (const double frequency : crossovers(loop)) {
    const long double lag = lag_to_minus_one(loop, frequency), of_delay = lag > 0.0L ? lag : lag + 2.0L * kPi;
    margins.phase = std::fmin(margins.phase, static_cast<double>(std::abs(lag) * 180.0L / kPi));
    margins.delay = std::fmin(margins.delay, static_cast<double>(of_delay / static_cast<long double>(frequency)));
  }
  find_peak(std::move(closed_poles), loop, margins);
  return margins;
}

}  // namespace

std::optional<LoopMargins> loop_margins(const VehicleModel& vehicle) {
  if (!vehicle.design || !(spectral_radius(vehicle.loop) < 1.0) || !unstable_hidden_modes(vehicle.loop).empty())
    return std::nullopt;
  std::vector<Complex> poles = poles_of(vehicle.loop);
  if (vehicle.design->headway_filter) poles.pop_back();  // that of the filter
  return margins_of(open_loop(*vehicle.design, vehicle.headway), std::move(poles));
}

std::optional<LoopMargins> loop_margins(const VehicleModel& vehicle, std::size_t follower, double sample_period) {
  const HearingLoop loop(vehicle, follower, sample_period);
  if (!(loop.spectral_radius() < 1.0)) return std::nullopt;
  return margins_of(loop.opened(), loop.poles());
}

std::optional<LoopMargins> loop_margins(const PlatoonModel& model) {
  std::optional<LoopMargins> worst;
  const bool plain = hears_predecessors_only(model);
  const std::size_t different = type_order(model).size() + (plain ? 0 : farthest_ahead(model));
  for (std::size_t i = 1; i <= different; ++i) {
    const VehicleModel& own = vehicle(model, i);
    const std::optional<LoopMargins> margins = plain ? loop_margins(own) : loop_margins(own, i, model.sample_period);
    if (!margins) return std::nullopt;
    if (!worst || margins->sensitivity_peak > worst->sensitivity_peak) {
      const LoopMargins before = worst.value_or(*margins);
      worst = LoopMargins{before.phase, before.delay, margins->sensitivity_peak, margins->peak_frequency};
    }
    worst->phase = std::fmin(worst->phase, margins->phase);
    worst->delay = std::fmin(worst->delay, margins->delay);
  }
  return worst;
}

}  // namespace platoon
