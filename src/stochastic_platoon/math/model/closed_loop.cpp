#include "stochastic_platoon/math/model/closed_loop.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "stochastic_platoon/math/model/exact_transfer.hpp"
#include "stochastic_platoon/math/numerics/circle_polynomial.hpp"
#include "stochastic_platoon/math/numerics/exact_resolvent.hpp"
#include "stochastic_platoon/math/numerics/zeros.hpp"

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
  if (unstable_hidden_modes(loop).empty())
    loop.exact = std::make_shared<const ExactFraction>(DesignedLoop(design, headway).transfer());
  loop.poles = poles_of(loop);
  return loop;
}

/// T without the leading coefficients of N that are zero to the rounding of A, B and C: the first C A^k B that are
/// below what small relative changes of all entries can make of them.
TransferFunction of_determined_degree(const TransferFunction& t, const StateSpace& system) {
  const auto sizes = [](const ExactMatrix& m) -> Eigen::MatrixXd { return m.cast<double>().cwiseAbs(); };
  const ExactMatrix a = system.a().cast<Exact>();
  std::vector<ExactMatrix> left{system.c().cast<Exact>()}, right{system.b().cast<Exact>()};  // C A^k, A^k B
  Polynomial n = t.numerator();
  for (std::size_t k = 0; n.size() > 1; ++k) {
    double sum = (sizes(left[0]) * sizes(right[k]) + sizes(left[k]) * sizes(right[0])).value();
    for (std::size_t j = 0; j < k; ++j) sum += (sizes(left[j]) * sizes(a) * sizes(right[k - 1 - j])).value();
    const double coefficient = product(left[0], right[k]).value().convert_to<double>();
    if (std::abs(coefficient) > kCoefficientRounding * sum) break;
    if (n.size() == system.order() - static_cast<Eigen::Index>(k)) n = n.tail(n.size() - 1).eval();
    left.push_back(product(left[k], a));
    right.push_back(product(a, right[k]));
  }
  return {n, t.denominator()};
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
  return loop.poles.empty() ? zeros(exact_fraction(loop).denominator) : loop.poles;
}

std::vector<std::complex<long double>> zeros_of(const ClosedLoop& loop) {
  return loop.zeros.empty() ? zeros(exact_fraction(loop).numerator) : loop.zeros;
}

std::vector<std::complex<double>> unstable_hidden_modes(const ClosedLoop& loop) {
  std::vector<std::complex<double>> modes;
  std::copy_if(loop.hidden_modes.begin(), loop.hidden_modes.end(), std::back_inserter(modes),
               [](const std::complex<double>& mode) { return !(std::abs(mode) < 1.0 - 1e-6); });
  return modes;
}

double spectral_radius(const ClosedLoop& loop) {
  if (!loop.exact) return spectral_radius(poles_of(loop));
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
  return spectral_radius(poles);
}

ClosedLoop close_loop(const LoopDesign& design, double headway, const ClosedLoop* before) {
  return is_by_parts(design) ? loop_by_parts(design, headway, before) : form_loop(design, headway);
}

ClosedLoop closed_loop_from(const StateSpace& realization) {
  require_order(realization.order());
  const auto r = std::make_shared<const Resolvent>(resolvent(realization));
  const Reduction t = reduce(of_determined_degree(r->transfer, realization));
  ClosedLoop loop{t.minimal, realization, {}, {}, r->delta_transfer};
  loop.poles = poles_of(loop);
  loop.zeros = zeros_of(loop);
  loop.given = r;
  return loop;
}

}  // namespace platoon
