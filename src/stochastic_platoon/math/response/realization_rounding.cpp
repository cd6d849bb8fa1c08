#include "stochastic_platoon/math/response/realization_rounding.hpp"

#include <cmath>
#include <cstddef>
#include <limits>

#include "stochastic_platoon/math/numerics/exact.hpp"

namespace platoon {

namespace {

using Complex = std::complex<long double>;

std::vector<CirclePolynomial> all_recentred(std::vector<CirclePolynomial> polynomials) {
  for (CirclePolynomial& p : polynomials) p = recentred(std::move(p));
  return polynomials;
}

std::vector<Complex> values(const std::vector<CirclePolynomial>& polynomials, Complex offset) {
  std::vector<Complex> result;
  result.reserve(polynomials.size());
  for (const CirclePolynomial& p : polynomials) result.push_back(evaluate(p, offset));
  return result;
}

}  // namespace

RealizationRounding::RealizationRounding(const StateSpace& system, const Resolvent& resolvent)
    : system_(system),
      near_{resolvent.delta_numerators, resolvent.delta_states, rounded_delta(resolvent.delta_transfer->numerator),
            resolvent.delta_denominator},
      far_{all_recentred(near_.outputs), all_recentred(near_.states), recentred(near_.numerator),
           recentred(near_.denominator)},
      at_one_(sensitivities(near_, 0.0L)) {}

std::vector<long double> RealizationRounding::sensitivities(const Half& half, Complex offset) const {
  const std::vector<Complex> x = values(half.outputs, offset), y = values(half.states, offset);
  const Complex over_n = 1.0L / evaluate(half.numerator, offset), over_d = over_n / evaluate(half.denominator, offset);
  std::vector<long double> result;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    const Complex passed = x[i] * over_d;
    for (std::size_t j = 0; j < y.size(); ++j) {
      const auto entry = static_cast<long double>(system_.a()(row, static_cast<Eigen::Index>(j)));
      result.push_back(entry * (passed.real() * y[j].real() - passed.imag() * y[j].imag()));
    }
    result.push_back(static_cast<long double>(system_.b()(row)) * (x[i] * over_n).real());
    result.push_back(static_cast<long double>(system_.c()(row)) * (y[i] * over_n).real());
  }
  return result;
}

double RealizationRounding::at(const CirclePoint& point) const {
  const std::vector<long double> here = sensitivities(point.centre == Centre::kOne ? near_ : far_, point.offset);
  long double sum = 0.0L;
  for (std::size_t k = 0; k < here.size(); ++k) sum += std::abs(here[k] - at_one_[k]);
  if (std::isnan(sum)) return std::numeric_limits<double>::infinity();
  return static_cast<double>(std::numeric_limits<double>::epsilon() * sum);
}

}  // namespace platoon
