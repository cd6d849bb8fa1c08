#include "stochastic_platoon/math/model/loop_assumptions.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <limits>
#include <stdexcept>

#include "stochastic_platoon/math/model/hearing_loop.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"

namespace platoon {

namespace {

struct RampGain {
  long double value;  ///< T(1)
  long double slope;  ///< dT/dz(1)
};

RampGain ramp_gain(const DeltaFraction& t) {
  const auto at = [](const DeltaPolynomial& p, std::size_t j) { return j < p.size() ? p[j] : 0.0L; };
  const long double value = at(t.numerator, 0) / at(t.denominator, 0);
  return {value, (at(t.numerator, 1) - value * at(t.denominator, 1)) / at(t.denominator, 0)};
}

// Double integral action as a property of T, to the accuracy of a realization given to six digits: T(1) = 1 and
// dT/dz(1) = -h, as H(1) T(1) = 1 and (H T)'(1) = 0.
bool tracks_a_ramp(const RampGain& gain, double headway) {
  return std::abs(gain.value - 1.0L) < 1e-4L && std::abs(gain.slope + headway) < 1e-3L * (1.0L + headway);
}

std::string missing_integral_action(const ClosedLoop& loop, const RampGain& gain, double headway) {
  std::string text = formatted(
      "no double integral action: G(z) K(z) must have two poles at z = 1, that is T(1) = 1 and dT/dz(1) = -h for h = %g; here ",
      headway);
  text += std::isfinite(gain.slope) ? formatted("T(1) = %Lg and dT/dz(1) = %Lg", gain.value, gain.slope)
                                    : "T has a pole at z = 1 itself";
  if (!loop.integrators) return text;
  return text + formatted(", as G(z) K(z) has %d pole%s there", std::max(*loop.integrators, 0),
                          *loop.integrators == 1 ? "" : "s");
}

/// The reason why the vehicles, whose coefficients of T are rounded to double, do not realize T; empty if they do.
std::string rounded_away(const ClosedLoop& loop, double headway) {
  if (loop.parts) return {};  // T(1) = 1 and dT/dz(1) = -h by construction
  const RampGain gain = ramp_gain({delta_form(loop.transfer.numerator()), delta_form(loop.transfer.denominator())});
  if (tracks_a_ramp(gain, headway) && (spectral_radius(loop) >= 1.0 || spectral_radius(loop.realization) < 1.0))
    return {};
  return formatted(
      "the closed loop is too slow for its sample period: its poles lie so close to z = 1 that in double its coefficients have T(1) = %Lg and dT/dz(1) = %Lg instead of 1 and -h for h = %g: increase sample_period, or decrease the headway",
      gain.value, gain.slope, headway);
}

/// The distance from z = 1 of the nearest pole.
long double slowest(const ClosedLoop& loop) {
  long double nearest = std::numeric_limits<long double>::infinity();
  for (const std::complex<long double>& s : poles_of(loop)) nearest = std::min(nearest, std::abs(s));
  return nearest;
}

/// The reason why the equilibrium of a loop with T(1) = 1 is not found: rounding, as that loop has no pole at z = 1.
std::string rounded_equilibrium(const ClosedLoop& loop) {
  return formatted(
      "the closed loop is too slow for its sample period: a pole lies %.3Lg beside z = 1, so close that A has an eigenvalue at 1 to the rounding of double, and the equilibrium in which the vehicles start is lost: increase sample_period, or the gain of the slow mode (ki), or decrease the headway",
      slowest(loop));
}

}  // namespace

double integral_defect(const ClosedLoop& loop, double headway) {
  const RampGain gain = ramp_gain(delta_fraction(loop));
  return static_cast<double>(std::abs(gain.value - 1.0L) + std::abs(gain.slope + headway) / (1.0L + headway));
}

std::vector<std::string> cancelled_unstable_modes(const ClosedLoop& loop) {
  std::vector<std::string> places;
  for (const std::complex<double>& mode : unstable_hidden_modes(loop)) {
    if (mode.imag() < 0.0) continue;
    const std::string pair = mode.imag() > 0.0 ? formatted(" +- i %g", mode.imag()) : "";
    places.push_back(formatted("z = %g", mode.real()) + pair);
  }
  return places;
}

std::vector<std::string> violated_assumptions(const ClosedLoop& loop, double headway, bool allow_unstable) {
  std::vector<std::string> found;
  if (!loop.transfer.is_strictly_proper()) {
    found.push_back("T(z) is not strictly proper: it must have more poles than zeros (relative degree of G K >= 1)");
  }
  const RampGain gain = ramp_gain(delta_fraction(loop));
  if ((loop.integrators && *loop.integrators < 2) || !tracks_a_ramp(gain, headway)) {
    found.push_back(missing_integral_action(loop, gain, headway));
  } else if (loop.integrators) {
    const std::string text = rounded_away(loop, headway);
    if (!text.empty()) return {text};  // rounding hides all other properties
  }
  const double rho = spectral_radius(loop);
  if (rho >= 1.0 && !allow_unstable) {
    found.push_back(
        formatted("the closed loop is unstable: rho(A) = %g, must be < 1 (allow_unstable: true runs it anyway)", rho));
  }
  if (!allow_unstable) {
    for (const std::string& mode : cancelled_unstable_modes(loop))
      found.push_back("G(z) K(z) cancels an unstable mode at " + mode +
                      ": cancelled modes must lie inside the unit circle (allow_unstable: true runs it anyway)");
  }
  if (rho >= 1.0 && !allow_unstable) return found;
  constexpr long double kNearest = 1e-11L;  // A to the rounding of double has five digits of this pole
  try {
    unit_equilibrium(loop.realization);
    if (slowest(loop) < kNearest) found.push_back(rounded_equilibrium(loop));
  } catch (const std::invalid_argument& error) {
    found.push_back(tracks_a_ramp(gain, headway) ? rounded_equilibrium(loop) : error.what());
  }
  return found;
}

std::vector<std::string> violated_assumptions(const VehicleModel& vehicle, double sample_period,
                                              const std::vector<std::size_t>& places, bool allow_unstable) {
  for (const std::size_t follower : allow_unstable ? std::vector<std::size_t>() : places) {
    const double rho = HearingLoop(vehicle, follower, sample_period).spectral_radius();
    if (rho >= 1.0)
      return {formatted("the closed loop is unstable: rho(A) = %g, must be < 1 (allow_unstable: true runs it anyway)",
                        rho)};
  }
  return {};
}

}  // namespace platoon
