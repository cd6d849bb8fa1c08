#include "stochastic_platoon/math/numerics/delta_form.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "stochastic_platoon/math/numerics/exact.hpp"

namespace platoon {

namespace {

using Complex = std::complex<long double>;

/// a / b without the overflow and infinity handling of std::complex, which is slow.
Complex quotient(Complex a, Complex b) {
  const long double size = std::norm(b);
  return {(a.real() * b.real() + a.imag() * b.imag()) / size, (a.imag() * b.real() - a.real() * b.imag()) / size};
}

Complex product(Complex a, Complex b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

struct NewtonStep {
  Complex step;       ///< p(s) / p'(s)
  bool rounding;      ///< |p(s)| is within the rounding of its evaluation
  long double doubt;  ///< relative error of s due to rounding
};

/// Evaluates the reversed polynomial if |s| > 1, to avoid overflow.
NewtonStep newton_step(const DeltaPolynomial& p, Complex s) {
  constexpr long double kRounding = 2.0L * std::numeric_limits<long double>::epsilon();
  const bool outside = std::norm(s) > 1.0L;
  const Complex x = outside ? quotient(1.0L, s) : s;
  const long double length = std::abs(x);
  Complex value = 0.0L;
  Complex slope = 0.0L;
  long double sum = 0.0L;  // of the moduli of the terms
  for (std::size_t i = 0; i < p.size(); ++i) {
    const long double coefficient = outside ? p[i] : p[p.size() - 1 - i];
    slope = product(slope, x) + value;
    value = product(value, x) + coefficient;
    sum = sum * length + std::abs(coefficient);
  }
  // |x q'(x)| dx/x = rounding, and dx/x = -ds/s
  const long double doubt = kRounding * sum / (std::abs(slope) * length);
  if (value == Complex(0.0L)) return {0.0L, true, doubt};
  const bool rounding = std::norm(value) <= kRounding * kRounding * sum * sum;
  if (!outside) return {quotient(value, slope), rounding, doubt};
  // p(s) = s^n q(1/s): p'/p = n/s - q'(1/s) / (q(1/s) s^2).
  const Complex inverse = product(x, static_cast<long double>(p.size() - 1) - quotient(product(x, slope), value));
  return {quotient(1.0L, inverse), rounding, doubt};
}

/// Base-2 logarithm of the approximate modulus of the largest zero, rounded; 0 if its modulus is not far from 1.
int scale_of_zeros(const DeltaPolynomial& p) {
  constexpr long double kFar = 30.0L;
  long double largest = -std::numeric_limits<long double>::infinity();
  for (std::size_t i = 0; i + 1 < p.size(); ++i) {
    const long double ratio = std::log2(std::abs(p[i] / p.back()));
    largest = std::max(largest, ratio / static_cast<long double>(p.size() - 1 - i));
  }
  return std::abs(largest) < kFar ? 0 : static_cast<int>(std::lround(largest));
}

/// p(2^scale t) divided by its leading coefficient.
DeltaPolynomial in_units_of(const DeltaPolynomial& p, int scale) {
  DeltaPolynomial q = p;
  for (std::size_t i = 0; i < q.size(); ++i)
    q[i] = std::ldexp(q[i] / p.back(), scale * (static_cast<int>(i) - static_cast<int>(q.size()) + 1));
  return q;
}

/// Divides q by 1 + s as long as 1 + s is a factor to rounding; each division adds a zero at z = 0 (s = -1) to `found`.
void deflate_at_origin_of_z(DeltaPolynomial& q, std::vector<Complex>& found) {
  constexpr long double kRounding = std::numeric_limits<long double>::epsilon();
  while (q.size() > 1) {
    DeltaPolynomial quotient(q.size() - 1);
    long double remainder = 0.0L, sum = 0.0L;
    for (std::size_t j = q.size(); j-- > 0;) {
      remainder = q[j] - remainder;
      sum += std::abs(q[j]);
      if (j > 0) quotient[j - 1] = remainder;
    }
    if (std::abs(remainder) > 16.0L * kRounding * sum) return;
    q.swap(quotient);
    found.emplace_back(-1.0L);
  }
}

/// Refines the zeros of q in fifty digits. Extended precision does not resolve the zeros of a cluster one by one, and
/// their product would not be that of q.
void settle_cluster(const DeltaPolynomial& q, std::vector<Complex>& s) {
  using Real = boost::multiprecision::number<boost::multiprecision::cpp_bin_float_50::backend_type,
                                             boost::multiprecision::et_off>;
  struct Pair {
    Real real, imag;
    Pair operator-(const Pair& b) const { return {real - b.real, imag - b.imag}; }
    Pair operator+(const Pair& b) const { return {real + b.real, imag + b.imag}; }
    Pair operator*(const Pair& b) const { return {real * b.real - imag * b.imag, real * b.imag + imag * b.real}; }
    Real norm() const { return real * real + imag * imag; }
    Pair operator/(const Pair& b) const {
      const Real size = b.norm();
      return {(real * b.real + imag * b.imag) / size, (imag * b.real - real * b.imag) / size};
    }
  };
  const Pair one{1, 0};
  std::vector<Pair> found;
  found.reserve(s.size());
  for (const Complex& zero : s) found.push_back({Real(zero.real()), Real(zero.imag())});
  for (int iteration = 0; iteration < 60; ++iteration) {
    bool settled = true;
    for (std::size_t i = 0; i < found.size(); ++i) {
      Pair value{0, 0}, slope{0, 0};
      for (std::size_t j = q.size(); j-- > 0;) {
        slope = slope * found[i] + value;
        value = value * found[i] + Pair{Real(q[j]), 0};
      }
      if (value.norm() == 0 || slope.norm() == 0) continue;
      const Pair newton = value / slope;
      Pair repulsion{0, 0};
      for (std::size_t j = 0; j < found.size(); ++j) {
        const Pair apart = found[i] - found[j];
        if (j != i && apart.norm() != 0) repulsion = repulsion + one / apart;
      }
      const Pair divisor = one - newton * repulsion;
      if (divisor.norm() == 0) continue;
      const Pair step = newton / divisor;
      found[i] = found[i] - step;
      settled = settled && step.norm() <= Real(1e-44) * found[i].norm();
    }
    if (settled) break;
  }
  for (std::size_t i = 0; i < s.size(); ++i)
    s[i] = {found[i].real.convert_to<long double>(), found[i].imag.convert_to<long double>()};
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
  for (std::size_t i = 0; i < n; ++i) result(static_cast<Eigen::Index>(n - 1 - i)) = static_cast<double>(b[i]);
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
  deflate_at_origin_of_z(q, found);
  if (q.size() < 2) return found;
  const int scale = scale_of_zeros(q);
  if (scale != 0) q = in_units_of(q, scale);
  Polynomial descending(static_cast<Eigen::Index>(q.size()));
  const long double largest = std::abs(
      *std::max_element(q.begin(), q.end(), [](long double a, long double b) { return std::abs(a) < std::abs(b); }));
  for (std::size_t i = 0; i < q.size(); ++i) {
    descending(static_cast<Eigen::Index>(q.size() - 1 - i)) = static_cast<double>(q[i] / largest);
  }
  const std::vector<std::complex<double>> start = roots(descending);
  std::vector<Complex> s(start.begin(), start.end());
  constexpr long double kRounding = 4.0L * std::numeric_limits<long double>::epsilon();
  long double doubt = 0.0L;
  for (int iteration = 0; iteration < 40; ++iteration) {
    bool settled = true;
    doubt = 0.0L;
    for (std::size_t i = 0; i < s.size(); ++i) {
      const NewtonStep newton = newton_step(q, s[i]);
      doubt = std::max(doubt, newton.doubt);
      Complex repulsion = 0.0L;
      for (std::size_t j = 0; j < s.size(); ++j) {
        if (j != i && s[i] != s[j]) repulsion += quotient(1.0L, s[i] - s[j]);
      }
      const Complex step = quotient(newton.step, 1.0L - product(newton.step, repulsion));
      if (!std::isfinite(step.real()) || !std::isfinite(step.imag())) continue;
      s[i] -= step;
      settled = settled && (newton.rounding || std::norm(step) <= kRounding * kRounding * std::norm(s[i]));
    }
    if (settled) break;
  }
  constexpr long double kClustered = 1e-7L;
  if (!(doubt < kClustered)) settle_cluster(q, s);
  for (const Complex& zero : s) found.emplace_back(std::ldexp(zero.real(), scale), std::ldexp(zero.imag(), scale));
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
