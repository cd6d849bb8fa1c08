#include "stochastic_platoon/theory/least_margin.hpp"

#include <cmath>
#include <limits>
#include <vector>

namespace platoon {

namespace {

/// The frequencies where 1 - |T|^2 may be smallest, relative to its zero at w = 0.
std::vector<double> margin_minima(const LoopSpectrum& spectrum) {
  std::vector<double> frequencies{0.0, frequency_at(0.0L, Centre::kMinusOne)};
  for (const Centre centre : {Centre::kOne, Centre::kMinusOne}) {
    const CirclePolynomial slope = derivative(spectrum.about(centre).stripped_margin);
    for (const long double t : sign_changes(slope, 0.0L, 1.0L))
      frequencies.push_back(frequency_at(t, centre));
    frequencies.push_back(frequency_at(1.0L, centre));
  }
  return frequencies;
}

}  // namespace

LeastMargin least_margin(const LoopSpectrum& spectrum) {
  LeastMargin least{Sign::kPositive, std::numeric_limits<double>::infinity(), 0.0};
  for (const double w : margin_minima(spectrum)) {
    double value = spectrum.stripped_margin(w);
    if (std::abs(value) <= spectrum.margin_uncertainty(w)) value = 0.0;
    if (value > least.value) continue;
    least = {value > 0.0 ? Sign::kPositive : value < 0.0 ? Sign::kNegative : Sign::kZero, value, w};
  }
  return least;
}

}  // namespace platoon
