#include "stochastic_platoon/model/delta_form.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "stochastic_platoon/model/exact.hpp"

namespace platoon {

namespace {

using Complex = std::complex<long double>;

/// a / b without the care for overflow and infinities that std::complex takes, and that takes its time.
Complex quotient(Complex a, Complex b) {
  const long double size = std::norm(b);
  return {(a.real() * b.real() + a.imag() * b.imag()) / size,
          (a.imag() * b.real() - a.real() * b.imag()) / size};
}

Complex product(Complex a, Complex b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

/// p(s) / p'(s), from the reversed polynomial where |s| > 1, so that nothing overflows.
Complex newton_step(const DeltaPolynomial& p, Complex s) {
  const bool outside = std::norm(s) > 1.0L;
  const Complex x = outside ? quotient(1.0L, s) : s;
  Complex value = 0.0L;
  Complex slope = 0.0L;
  for (std::size_t i = 0; i < p.size(); ++i) {
    slope = product(slope, x) + value;
    value = product(value, x) + (outside ? p[i] : p[p.size() - 1 - i]);
  }
  if (value == Complex(0.0L)) return 0.0L;
  if (!outside) return quotient(value, slope);
  // p(s) = s^n q(1/s): p'/p = n/s - q'(1/s) / (q(1/s) s^2).
  return quotient(1.0L,
                  product(x, static_cast<long double>(p.size() - 1) - quotient(product(x, slope), value)));
}

}  // namespace

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
  for (std::size_t i = 0; i < n; ++i)
    result(static_cast<Eigen::Index>(n - 1 - i)) = static_cast<double>(b[i]);
  return result;
}

std::vector<std::complex<long double>> zeros(const DeltaPolynomial& p) {
  DeltaPolynomial q = p;
  while (q.size() > 1 && q.back() == 0.0L) q.pop_back();
  std::vector<Complex> found;
  while (q.size() > 1 && q.front() == 0.0L) {
    q.erase(q.begin());
    found.emplace_back(0.0L);
  }
  if (q.size() < 2) return found;
  Polynomial descending(static_cast<Eigen::Index>(q.size()));
  const long double largest = std::abs(*std::max_element(
      q.begin(), q.end(), [](long double a, long double b) { return std::abs(a) < std::abs(b); }));
  for (std::size_t i = 0; i < q.size(); ++i) {
    descending(static_cast<Eigen::Index>(q.size() - 1 - i)) = static_cast<double>(q[i] / largest);
  }
  const std::vector<std::complex<double>> start = roots(descending);
  std::vector<Complex> s(start.begin(), start.end());
  constexpr long double kRounding = 4.0L * std::numeric_limits<long double>::epsilon();
  constexpr long double kNear = 1e-6L;
  std::vector<long double> before(s.size(), std::numeric_limits<long double>::infinity());
  for (int iteration = 0; iteration < 40; ++iteration) {
    bool settled = true;
    for (std::size_t i = 0; i < s.size(); ++i) {
      const Complex newton = newton_step(q, s[i]);
      Complex repulsion = 0.0L;
      for (std::size_t j = 0; j < s.size(); ++j) {
        if (j != i && s[i] != s[j]) repulsion += quotient(1.0L, s[i] - s[j]);
      }
      const Complex step = quotient(newton, 1.0L - product(newton, repulsion));
      if (!std::isfinite(step.real()) || !std::isfinite(step.imag())) continue;
      s[i] -= step;
      const long double size = std::norm(step), place = std::norm(s[i]);
      // Where zeros lie close together, rounding keeps steps from vanishing: they stop to shrink instead.
      const bool shrinks = size < before[i] || size > kNear * kNear * place;
      settled = settled && (size <= kRounding * kRounding * place || !shrinks);
      before[i] = size;
    }
    if (settled) break;
  }
  found.insert(found.end(), s.begin(), s.end());
  return found;
}

double spectral_radius(const DeltaPolynomial& p) {
  long double excess = -1.0L;
  for (const Complex& s : zeros(p)) excess = std::max(excess, modulus_minus_one(s));
  return static_cast<double>(1.0L + excess);
}

long double modulus_minus_one(std::complex<long double> s) {
  const long double excess = 2.0L * s.real() + std::norm(s);  // |1 + s|^2 - 1
  return excess / (1.0L + std::abs(1.0L + s));
}

}  // namespace platoon
