#include "stochastic_platoon/math/model/closed_loop.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "stochastic_platoon/math/model/exact_transfer.hpp"
#include "stochastic_platoon/math/numerics/delayed_zeros.hpp"

namespace platoon {

namespace {

void require_order(Eigen::Index order) {
  if (order <= kHighestOrder) return;
  throw std::invalid_argument("order " + std::to_string(order) + ": the closed loop must have at most " +
                              std::to_string(kHighestOrder) + " poles");
}

/// With G K = n / (d divisor) z^-q and H = ((1 + h) z - h) / z: T = n z / (d z^(q+1) divisor + n ((1 + h) z - h)), or
/// n z / (((1 + h) z - h) (d z^q divisor + n)) with a headway filter.
class DesignedLoop {
public:
  DesignedLoop(const LoopDesign& design, double headway)
      : filtered_(design.headway_filter), policy_{Exact(1), Exact(1) + Exact(headway)} {
    const ExactTransfer &plant = design.plant.exact(), &controller = design.controller.exact();
    const std::ptrdiff_t q = plant.delay + controller.delay;
    delay_ = filtered_ ? q : q + 1;
    numerator_ = times_power_of_z(multiply(plant.numerator, controller.numerator), -delay_);
    fed_back_ = filtered_ ? numerator_ : multiply(numerator_, policy_);
    open_ = multiply(plant.denominator, controller.denominator);
    if (design.divide_by_one_plus_headway) {
      for (Exact& coefficient : open_) coefficient *= policy_[1];
    }
  }

  ExactFraction transfer() const {
    const ExactPolynomial closed = add(times_power_of_z(open_, delay_), fed_back_);
    const ExactPolynomial denominator = filtered_ ? multiply(policy_, closed) : closed;
    const auto monic = [&](ExactPolynomial p) {
      for (Exact& coefficient : p) coefficient /= denominator.back();
      return p;
    };
    return {monic(times_power_of_z(numerator_, 1)), monic(denominator)};
  }

  /// With a headway filter only the last pole depends on the headway.
  std::vector<std::complex<long double>> poles(const ClosedLoop* before) const {
    std::vector<std::complex<long double>> found;
    if (filtered_ && before != nullptr && !before->poles.empty()) {
      found.assign(before->poles.begin(), before->poles.end() - 1);
    } else {
      found = zeros_behind_delay(open_, static_cast<std::size_t>(std::max<std::ptrdiff_t>(delay_, 0)), fed_back_);
    }
    if (filtered_) found.emplace_back(Exact(-1 / policy_[1]).convert_to<long double>());
    return found;
  }

private:
  bool filtered_;
  ExactPolynomial policy_;  ///< (1 + h) z - h
  std::ptrdiff_t delay_;
  ExactPolynomial numerator_, fed_back_, open_;  ///< T = z numerator / (open z^delay + fed_back), over the policy
};

// Modes are computed as zeros of polynomials, so a mode within rounding of the unit circle counts as on it.
bool is_inside_unit_circle(std::complex<double> mode) {
  return std::abs(mode) < 1.0 - 1e-6;
}

ClosedLoop loop_by_parts(const LoopDesign& design, double headway, const ClosedLoop* before) {
  const ExactTransfer &plant = design.plant.exact(), &controller = design.controller.exact();
  const auto order = static_cast<Eigen::Index>(plant.denominator.size() + controller.denominator.size() - 1);
  require_order(order + std::max<Eigen::Index>(controller.delay, 0));
  const LoopParts parts = loop_parts<double>(design, headway);
  const DesignedLoop designed(design, headway);
  ExactFraction exact = designed.transfer();
  const int integrators = plant.integrators() + controller.integrators();
  const TransferFunction transfer{rounded(shifted_to_origin(exact.numerator)),
                                  rounded(shifted_to_origin(exact.denominator))};
  return {transfer,
          realization(parts),
          {},
          integrators,
          std::make_shared<const ExactFraction>(std::move(exact)),
          designed.poles(before),
          parts};
}

ClosedLoop form_loop(const LoopDesign& design, double headway) {
  const TransferFunction& plant = std::get<TransferFunction>(design.plant.given());
  const TransferFunction& controller = std::get<TransferFunction>(design.controller.given());
  for (const TransferFunction* part : {&plant, &controller}) {
    if (part->numerator()(0) == 0.0)
      throw std::invalid_argument("G(z) K(z) = 0: neither plant nor controller may be zero");
  }
  require_order(plant.denominator().size() + controller.denominator().size() - 1);
  const double divisor = design.divide_by_one_plus_headway ? 1.0 + headway : 1.0;
  const TransferFunction open_loop = series(plant, {controller.numerator() / divisor, controller.denominator()});
  const Reduction t = reduce(feedback(open_loop, headway_policy(headway)));
  const int integrators = multiplicity_at_one(plant.denominator()) + multiplicity_at_one(controller.denominator()) -
                          multiplicity_at_one(plant.numerator()) - multiplicity_at_one(controller.numerator());
  ClosedLoop loop{t.minimal, observable_canonical(t.minimal), roots(t.common_factor), integrators, {}};
  if (std::all_of(loop.hidden_modes.begin(), loop.hidden_modes.end(), is_inside_unit_circle))
    loop.exact = std::make_shared<const ExactFraction>(DesignedLoop(design, headway).transfer());
  return loop;
}

}  // namespace

ExactFraction exact_fraction(const ClosedLoop& loop) {
  if (loop.exact) return *loop.exact;
  return {shifted_to_one(exact(loop.transfer.numerator())), shifted_to_one(exact(loop.transfer.denominator()))};
}

DeltaFraction delta_fraction(const ClosedLoop& loop) {
  if (loop.exact) return {rounded_delta(loop.exact->numerator), rounded_delta(loop.exact->denominator)};
  return {delta_form(loop.transfer.numerator()), delta_form(loop.transfer.denominator())};
}

std::vector<std::complex<long double>> poles_of(const ClosedLoop& loop) {
  return loop.poles.empty() ? zeros(delta_fraction(loop).denominator) : loop.poles;
}

double spectral_radius(const ClosedLoop& loop) {
  if (!loop.exact) return spectral_radius(delta_form(loop.transfer.denominator()));
  // Factors cancelled in T remain in `exact` and are no modes of A; zeros at z = 0 are cancelled in both.
  std::vector<std::complex<long double>> poles = poles_of(loop);
  for (const std::complex<double>& mode : loop.hidden_modes) {
    if (mode == 0.0 || poles.empty()) continue;
    const auto distance = [&](const std::complex<long double>& s) {
      return std::norm(s - (static_cast<std::complex<long double>>(mode) - 1.0L));
    };
    poles.erase(std::min_element(poles.begin(), poles.end(),
                                 [&](const auto& a, const auto& b) { return distance(a) < distance(b); }));
  }
  long double excess = -1.0L;
  for (const std::complex<long double>& s : poles) excess = std::max(excess, modulus_minus_one(s));
  return static_cast<double>(1.0L + excess);
}

ClosedLoop close_loop(const LoopDesign& design, double headway, const ClosedLoop* before) {
  return is_by_parts(design) ? loop_by_parts(design, headway, before) : form_loop(design, headway);
}

ClosedLoop close_loop(const TransferFunction& plant, const TransferFunction& controller, double headway) {
  return form_loop({plant, controller}, headway);
}

ClosedLoop closed_loop_from(const StateSpace& realization) {
  require_order(realization.order());
  const Resolvent r = resolvent(realization);
  const Reduction t = reduce({r.transfer_numerator, r.denominator});
  return {t.minimal, realization, {}, {}, r.delta_transfer};
}

TransferFunction sensitivity(const TransferFunction& transfer, double headway) {
  const TransferFunction ht = series(headway_policy(headway), transfer);
  return {add(ht.denominator(), -ht.numerator()), ht.denominator()};
}

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
  std::ostringstream text;
  text
      << "no double integral action: G(z) K(z) must have two poles at z = 1, that is T(1) = 1 and dT/dz(1) = -h for h = "
      << headway << "; here T(1) = " << gain.value << " and dT/dz(1) = " << gain.slope;
  if (loop.integrators) {
    text << ", as G(z) K(z) has " << std::max(*loop.integrators, 0)
         << (*loop.integrators == 1 ? " pole there" : " poles there");
  }
  return text.str();
}

/// The reason why the vehicles, whose coefficients of T are rounded to double, do not realize T; empty if they do.
std::string rounded_away(const ClosedLoop& loop, double headway) {
  const RampGain gain = ramp_gain({delta_form(loop.transfer.numerator()), delta_form(loop.transfer.denominator())});
  if (loop.parts) return {};  // T(1) = 1 and dT/dz(1) = -h by construction
  if (tracks_a_ramp(gain, headway) && (spectral_radius(loop) >= 1.0 || spectral_radius(loop.realization) < 1.0))
    return {};
  std::ostringstream text;
  text
      << "the closed loop is too slow for its sample period: its poles lie so close to z = 1 that in double its coefficients have T(1) = "
      << gain.value << " and dT/dz(1) = " << gain.slope << " instead of 1 and -h for h = " << headway
      << ": increase sample_period";
  return text.str();
}

}  // namespace

double integral_defect(const ClosedLoop& loop, double headway) {
  const RampGain gain = ramp_gain(delta_fraction(loop));
  return static_cast<double>(std::abs(gain.value - 1.0L) + std::abs(gain.slope + headway) / (1.0L + headway));
}

std::vector<std::string> violated_assumptions(const ClosedLoop& loop, double headway, bool allow_unstable) {
  std::vector<std::string> found;
  const auto report = [&found](const std::ostringstream& text) { found.push_back(text.str()); };
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
    std::ostringstream text;
    text << "the closed loop is unstable: rho(A) = " << rho << ", must be < 1 (allow_unstable: true runs it anyway)";
    report(text);
  }
  for (const std::complex<double>& mode : loop.hidden_modes) {
    if (is_inside_unit_circle(mode) || allow_unstable || mode.imag() < 0.0) continue;
    std::ostringstream text;
    text << "G(z) K(z) cancels an unstable mode at z = " << mode.real() << (mode.imag() > 0.0 ? " +- i " : "");
    if (mode.imag() > 0.0) text << mode.imag();
    text << ": cancelled modes must lie inside the unit circle (allow_unstable: true runs it anyway)";
    report(text);
  }
  if (rho >= 1.0 && !allow_unstable) return found;
  try {
    unit_equilibrium(loop.realization);
  } catch (const std::invalid_argument& error) {
    found.emplace_back(error.what());
  }
  return found;
}

}  // namespace platoon
