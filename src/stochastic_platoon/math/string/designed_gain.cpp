#include "stochastic_platoon/math/string/designed_gain.hpp"

#include <cstdlib>
#include <limits>

#include "stochastic_platoon/math/model/exact_transfer.hpp"

namespace platoon {

namespace {

using Complex = std::complex<long double>;

/// |1 + w|^2 - 1.
long double excess_of(Complex w) {
  return 2.0L * w.real() + std::norm(w);
}

}  // namespace

DesignedGain::DesignedGain(const LoopDesign& design, double headway)
    : delay_(design.plant.exact().delay + design.controller.exact().delay),
      filtered_(design.headway_filter),
      headway_(headway) {
  const ExactTransfer &plant = design.plant.exact(), &controller = design.controller.exact();
  ExactPolynomial denominator = multiply(plant.denominator, controller.denominator);
  if (design.divide_by_one_plus_headway) {
    for (Exact& coefficient : denominator) coefficient *= Exact(1) + Exact(headway);
  }
  numerator_ = rounded_delta(multiply(plant.numerator, controller.numerator));
  denominator_ = rounded_delta(denominator);
}

DesignedGain::Value DesignedGain::at(const CirclePoint& point) const {
  const bool near = point.centre == Centre::kOne;
  const Complex s = near ? point.offset : point.offset - 2.0L, z = 1.0L + s;
  const long double from_one = -s.real();  // 1 - cos w
  const Complex n = evaluate(numerator_, s);
  if (std::norm(n) == 0.0L) return {0.0L, std::numeric_limits<long double>::infinity()};
  const Complex delay = power(delay_ < 0 ? std::conj(z) : z, static_cast<std::size_t>(std::abs(delay_)));
  const Complex d = evaluate(denominator_, s) * delay;
  const Complex policy = Complex(1.0L + headway_) - headway_ * std::conj(z), w = d / n;
  const long double of_policy = 2.0L * headway_ * (1.0L + headway_) * from_one;
  if (!filtered_) {
    return {n / (d + policy * n), of_policy + 2.0L * (std::conj(policy) * w).real() + std::norm(w)};
  }
  const long double of_loop = excess_of(w);
  return {n / (policy * (d + n)), of_policy + of_loop + of_policy * of_loop};
}

}  // namespace platoon
