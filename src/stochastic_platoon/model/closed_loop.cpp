#include "stochastic_platoon/model/closed_loop.hpp"

#include <cmath>
#include <sstream>
#include <stdexcept>

namespace platoon {

ClosedLoop close_loop(const TransferFunction& plant, const TransferFunction& controller, double headway) {
  const TransferFunction open_loop = series(plant, controller);
  const Reduction t = reduce(feedback(open_loop, headway_policy(headway)));
  return {t.minimal, observable_canonical(t.minimal), roots(t.common_factor),
          multiplicity_at_one(reduce(open_loop).minimal.denominator())};
}

ClosedLoop close_loop(const LoopDesign& design, double headway) {
  const double divisor = design.divide_by_one_plus_headway ? 1.0 + headway : 1.0;
  return close_loop(design.plant, {design.controller.numerator() / divisor, design.controller.denominator()},
                    headway);
}

ClosedLoop closed_loop_from(const StateSpace& realization) {
  const Reduction t = reduce(transfer_function(realization));
  return {t.minimal, realization, {}};
}

TransferFunction sensitivity(const TransferFunction& transfer, double headway) {
  const TransferFunction ht = series(headway_policy(headway), transfer);
  return {add(ht.denominator(), -ht.numerator()), ht.denominator()};
}

namespace {

// Double integral action, or what it means for T, to the accuracy of a realization given to six digits: T(1)
// = 1 and dT/dz(1) = -h, as H(1) T(1) = 1 and (H T)'(1) = 0.
bool tracks_a_ramp(const ClosedLoop& loop, double headway) {
  if (loop.integrators) return *loop.integrators >= 2;
  const Polynomial& n = loop.transfer.numerator();
  const Polynomial& d = loop.transfer.denominator();
  const double gain = n.sum() / d.sum();
  const double slope = (derivative(n).sum() - gain * derivative(d).sum()) / d.sum();
  return std::abs(gain - 1.0) < 1e-4 && std::abs(slope + headway) < 1e-3 * (1.0 + headway);
}

// Modes are zeros of polynomials: on the unit circle up to rounding is on it.
bool is_inside_unit_circle(std::complex<double> mode) {
  return std::abs(mode) < 1.0 - 1e-6;
}

}  // namespace

std::vector<std::string> violated_assumptions(const ClosedLoop& loop, double headway, bool allow_unstable) {
  std::vector<std::string> found;
  const auto report = [&found](const std::ostringstream& text) { found.push_back(text.str()); };
  if (!loop.transfer.is_strictly_proper()) {
    found.push_back(
        "T(z) is not strictly proper: it must have more poles than zeros (relative degree of G K >= 1)");
  }
  if (!tracks_a_ramp(loop, headway)) {
    std::ostringstream text;
    text << "no double integral action: G(z) K(z) must have two poles at z = 1, that is T(1) = 1 and "
            "dT/dz(1) = -h for "
            "h = "
         << headway << "; here T(1) = " << loop.transfer(1.0).real();
    report(text);
  }
  const double rho = spectral_radius(loop.realization);
  if (rho >= 1.0 && !allow_unstable) {
    std::ostringstream text;
    text << "the closed loop is unstable: rho(A) = " << rho
         << ", must be < 1 (allow_unstable: true runs it all the same)";
    report(text);
  }
  for (const std::complex<double>& mode : loop.hidden_modes) {
    if (is_inside_unit_circle(mode) || allow_unstable || mode.imag() < 0.0) continue;
    std::ostringstream text;
    text << "G(z) K(z) cancels an unstable mode at z = " << mode.real()
         << (mode.imag() > 0.0 ? " +- i " : "");
    if (mode.imag() > 0.0) text << mode.imag();
    text << ": cancelled modes must lie inside the unit circle (allow_unstable: true runs it all the same)";
    report(text);
  }
  try {
    unit_equilibrium(loop.realization);
  } catch (const std::invalid_argument& error) {
    found.emplace_back(error.what());
  }
  return found;
}

}  // namespace platoon
