#include "stochastic_platoon/theory/pattern_gain.hpp"

#include <cmath>

#include "stochastic_platoon/model/special_values.hpp"
#include "stochastic_platoon/theory/loop_spectrum.hpp"

namespace platoon {

PatternGain::PatternGain(const std::vector<LinkedVehicle>& vehicles) {
  for (const Centre centre : {Centre::kOne, Centre::kMinusOne}) {
    Half& part = centre == Centre::kOne ? near_ : far_;
    part.numerator = part.denominator = {1.0L};
    for (const LinkedVehicle& vehicle : vehicles) {
      part.numerator = multiply(part.numerator, vehicle.gain_numerator(centre));
      part.denominator = multiply(part.denominator, vehicle.gain_denominator(centre));
    }
    part.margin = subtract(part.denominator, part.numerator);
  }
  near_.margin = without_zero_at_origin(near_.margin);
  while (near_.margin.size() > 1 && std::abs(near_.margin.front()) <= doubt(0.0L, Centre::kOne)) {
    near_.margin = without_zero_at_origin(near_.margin);
    ++zeros_;
  }
}

LeastMargin PatternGain::least() const {
  LeastMargin least{Sign::kPositive, kInfinity, 0.0};
  for (const Centre centre : {Centre::kOne, Centre::kMinusOne}) {
    const Half& part = about(centre);
    std::vector<long double> places = sign_changes(derivative(part.margin), 0.0L, 1.0L);
    places.push_back(0.0L);
    places.push_back(1.0L);
    for (const long double t : places) {
      long double value = evaluate(part.margin, t);
      if (std::abs(value) <= doubt(t, centre)) value = 0.0L;
      const auto relative = static_cast<double>(value / evaluate(part.denominator, t));
      if (relative > least.value) continue;
      least = {relative > 0.0   ? Sign::kPositive
               : relative < 0.0 ? Sign::kNegative
                                : Sign::kZero,
               relative, frequency_at(t, centre)};
    }
  }
  return least;
}

std::vector<double> PatternGain::critical_frequencies() const {
  std::vector<double> frequencies{frequency_at(0.0L, Centre::kMinusOne)};
  for (const Centre centre : {Centre::kOne, Centre::kMinusOne}) {
    const Half& part = about(centre);
    const CirclePolynomial slope = subtract(multiply(derivative(part.numerator), part.denominator),
                                            multiply(part.numerator, derivative(part.denominator)));
    for (const long double t : sign_changes(slope, 0.0L, 1.0L))
      frequencies.push_back(frequency_at(t, centre));
    frequencies.push_back(frequency_at(1.0L, centre));
  }
  return frequencies;
}

std::vector<std::complex<double>> PatternGain::margin_frequencies() const {
  std::vector<std::complex<double>> frequencies;
  for (const std::complex<long double>& t : platoon::zeros(near_.margin)) {
    const std::complex<long double> w = 2.0L * std::asin(std::sqrt(t / 2.0L));
    if (std::abs(w.imag()) > 1e-12L) frequencies.emplace_back(w);
  }
  return frequencies;
}

// What the rounding of the coefficients of both may add to the margin.
long double PatternGain::doubt(long double t, Centre centre) const {
  const Half& part = about(centre);
  const auto divided = [&](CirclePolynomial p) {
    for (int j = 0; j < zeros_ && centre == Centre::kOne; ++j) p = without_zero_at_origin(p);
    return magnitude(p, t);
  };
  return kCoefficientRounding * (divided(part.numerator) + divided(part.denominator));
}

}  // namespace platoon
