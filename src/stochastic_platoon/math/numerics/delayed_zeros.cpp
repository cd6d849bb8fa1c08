#include "stochastic_platoon/math/numerics/delayed_zeros.hpp"

#include <limits>

#include "stochastic_platoon/math/numerics/circle_polynomial.hpp"

namespace platoon {

namespace {

using Complex = std::complex<long double>;

struct Value {
  Complex value, slope;
  long double size;  ///< sum of the moduli of the terms
};

Value rated(const DeltaPolynomial& p, Complex s) {
  Value result{0.0L, 0.0L, 0.0L};
  const long double length = std::abs(s);
  for (auto c = p.rbegin(); c != p.rend(); ++c) {
    result.slope = result.slope * s + result.value;
    result.value = result.value * s + *c;
    result.size = result.size * length + std::abs(*c);
  }
  return result;
}

}  // namespace

std::vector<std::complex<long double>> zeros_behind_delay(const ExactPolynomial& a, std::size_t delay,
                                                          const ExactPolynomial& b) {
  const DeltaPolynomial first = rounded_delta(a), second = rounded_delta(b);
  const std::vector<std::complex<double>> start =
      roots(rounded(shifted_to_origin(add(times_power_of_z(a, static_cast<std::ptrdiff_t>(delay)), b))));
  std::vector<Complex> s;
  s.reserve(start.size());
  for (const std::complex<double>& z : start) s.push_back(static_cast<Complex>(z) - 1.0L);
  constexpr long double kRounding = 4.0L * std::numeric_limits<long double>::epsilon();
  for (int iteration = 0; iteration < 40; ++iteration) {
    bool settled = true;
    for (std::size_t i = 0; i < s.size(); ++i) {
      const Value p = rated(first, s[i]), q = rated(second, s[i]);
      const Complex z = 1.0L + s[i], before = delay > 0 ? power(z, delay - 1) : 0.0L,
                    passed = delay > 0 ? before * z : 1.0L;
      const Complex value = p.value * passed + q.value;
      const Complex slope = p.slope * passed + static_cast<long double>(delay) * before * p.value + q.slope;
      if (std::abs(value) <= kRounding * (p.size * std::abs(passed) + q.size)) continue;
      const Complex newton = value / slope;
      Complex repulsion = 0.0L;
      for (std::size_t j = 0; j < s.size(); ++j) {
        if (j != i && s[i] != s[j]) repulsion += 1.0L / (s[i] - s[j]);
      }
      const Complex step = newton / (1.0L - newton * repulsion);
      if (!std::isfinite(step.real()) || !std::isfinite(step.imag())) continue;
      s[i] -= step;
      settled = settled && std::norm(step) <= kRounding * kRounding * std::norm(s[i]);
    }
    if (settled) break;
  }
  return s;
}

}  // namespace platoon
