#include "stochastic_platoon/math/numerics/delta_form.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "stochastic_platoon/math/numerics/zeros.hpp"

namespace platoon {

DeltaPolynomial delta_form(const Polynomial& p) {
  return rounded_delta(shifted_to_one(exact(p)));
}

Polynomial z_form(const DeltaPolynomial& p) {
  DeltaPolynomial b = p;
  const std::size_t n = b.size();
  for (std::size_t j = 0; j + 1 < n; ++j) {
    for (std::size_t i = n - 1; i-- > j;) b[i] -= b[i + 1];
  }
  Polynomial result(static_cast<Eigen::Index>(n));
  for (std::size_t i = 0; i < n; ++i) result(static_cast<Eigen::Index>(n - 1 - i)) = static_cast<double>(b[i]);
  return result;
}

std::vector<std::complex<long double>> zeros(const DeltaPolynomial& p) {
  return zeros(ExactPolynomial(p.begin(), p.end()), 16.0L * std::numeric_limits<long double>::epsilon());
}

double spectral_radius(const DeltaPolynomial& p) {
  return spectral_radius(zeros(p));
}

double spectral_radius(const std::vector<std::complex<long double>>& places) {
  long double excess = -1.0L;
  for (const std::complex<long double>& s : places) excess = std::max(excess, modulus_minus_one(s));
  return static_cast<double>(1.0L + excess);
}

long double modulus_minus_one(std::complex<long double> s) {
  const long double excess = 2.0L * s.real() + std::norm(s);  // |1 + s|^2 - 1
  return excess / (1.0L + std::abs(1.0L + s));
}

std::vector<std::complex<double>> frequencies_of(const std::vector<std::complex<long double>>& places) {
  std::vector<std::complex<double>> frequencies;
  for (const std::complex<long double>& s : places) {
    const long double excess = modulus_minus_one(s);
    if (excess <= -1.0L) continue;  // z = 0 is infinitely far from the circle
    frequencies.emplace_back(static_cast<double>(std::arg(1.0L + s)), static_cast<double>(-std::log1p(excess)));
  }
  return frequencies;
}

}  // namespace platoon
