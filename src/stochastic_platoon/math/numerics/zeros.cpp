#include "stochastic_platoon/math/numerics/zeros.hpp"

#include <algorithm>
#include <boost/math/constants/constants.hpp>
#include <cmath>
#include <limits>

#include "stochastic_platoon/math/numerics/circle_polynomial.hpp"
#include "stochastic_platoon/math/numerics/complex_product.hpp"

namespace platoon {

namespace {

using Complex = std::complex<long double>;

constexpr long double kUnit = std::numeric_limits<long double>::epsilon();

/// a / b without the overflow and infinity handling of std::complex, which is slow.
Complex quotient(Complex a, Complex b) {
  const long double size = std::norm(b);
  return {(a.real() * b.real() + a.imag() * b.imag()) / size, (a.imag() * b.real() - a.real() * b.imag()) / size};
}

struct NewtonStep {
  Complex step;       ///< p(s) / p'(s)
  bool rounding;      ///< |p(s)| is within the rounding of its evaluation
  long double doubt;  ///< relative error of s due to rounding
};

/// Evaluates the reversed polynomial if |s| > 1, to avoid overflow.
NewtonStep newton_step(const DeltaPolynomial& p, Complex s) {
  const bool outside = std::norm(s) > 1.0L;
  const Complex x = outside ? quotient(1.0L, s) : s;
  const long double length = std::abs(x);
  Complex value = 0.0L;
  Complex slope = 0.0L;
  long double sum = 0.0L;  // sum of the moduli of all terms
  for (std::size_t i = 0; i < p.size(); ++i) {
    const long double coefficient = outside ? p[i] : p[p.size() - 1 - i];
    slope = product(slope, x) + value;
    value = product(value, x) + coefficient;
    sum = sum * length + std::abs(coefficient);
  }
  const long double noise = 2.0L * kUnit * sum;
  // |x q'(x)| dx/x = noise, and dx/x = -ds/s
  const long double doubt = noise / (std::abs(slope) * length);
  if (value == Complex(0.0L)) return {0.0L, true, doubt};
  const bool rounding = std::norm(value) <= noise * noise;
  if (!outside) return {quotient(value, slope), rounding, doubt};
  // p(s) = s^n q(1/s): p'/p = n/s - q'(1/s) / (q(1/s) s^2).
  const Complex inverse = product(x, static_cast<long double>(p.size() - 1) - quotient(product(x, slope), value));
  return {quotient(1.0L, inverse), rounding, doubt};
}

/// Aberth's iteration with the Newton steps of a function. Returns the largest doubt about a zero.
template <class Newton>
long double iterate(std::vector<Complex>& s, const Newton& newton_at) {
  constexpr long double kSettled = 4.0L * kUnit;
  constexpr int kMostIterations = 200;
  long double doubt = 0.0L;
  for (int iteration = 0; iteration < kMostIterations; ++iteration) {
    bool settled = true;
    doubt = 0.0L;
    for (std::size_t i = 0; i < s.size(); ++i) {
      const NewtonStep newton = newton_at(s[i]);
      doubt = std::max(doubt, newton.doubt);
      Complex repulsion = 0.0L;
      for (std::size_t j = 0; j < s.size(); ++j) {
        if (j != i && s[i] != s[j]) repulsion += quotient(1.0L, s[i] - s[j]);
      }
      const Complex step = quotient(newton.step, 1.0L - product(newton.step, repulsion));
      if (!std::isfinite(step.real()) || !std::isfinite(step.imag())) continue;
      s[i] -= step;
      settled = settled && (newton.rounding || std::norm(step) <= kSettled * kSettled * std::norm(s[i]));
    }
    if (settled) break;
  }
  return doubt;
}

/// One start per zero. An edge of the upper hull of the points (i, log |p_i|) from i to j stands for j - i zeros of
/// modulus |p_i / p_j|^(1 / (j - i)), to a factor.
std::vector<Complex> starts_of(const DeltaPolynomial& p) {
  struct Point {
    std::size_t power;
    long double height;
    long double slope_to(const Point& right) const {
      return (right.height - height) / static_cast<long double>(right.power - power);
    }
  };
  std::vector<Point> hull;
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (p[i] == 0.0L) continue;
    const Point point{i, std::log2(std::abs(p[i]))};
    while (hull.size() > 1 && hull[hull.size() - 2].slope_to(hull.back()) <= hull.back().slope_to(point))
      hull.pop_back();
    hull.push_back(point);
  }
  constexpr long double kStartTurn = 0.7L;  // no start and no set of starts is its own conjugate
  std::vector<Complex> starts;
  for (std::size_t edge = 0; edge + 1 < hull.size(); ++edge) {
    const std::size_t count = hull[edge + 1].power - hull[edge].power;
    const long double radius = std::exp2(-hull[edge].slope_to(hull[edge + 1]));
    for (std::size_t k = 0; k < count; ++k) {
      const long double angle = boost::math::long_double_constants::two_pi * static_cast<long double>(k);
      starts.push_back(std::polar(
          radius, angle / static_cast<long double>(count) + kStartTurn * static_cast<long double>(edge + 1)));
    }
  }
  return starts;
}

/// Divides q by 1 + s as long as 1 + s is a factor to rounding; each division adds a zero at z = 0 (s = -1) to `found`.
void deflate_at_origin_of_z(ExactPolynomial& q, const Exact& rounding, std::vector<Complex>& found) {
  while (q.size() > 1) {
    ExactPolynomial quotient(q.size() - 1);
    Exact remainder = 0, sum = 0;
    for (std::size_t j = q.size(); j-- > 0;) {
      remainder = q[j] - remainder;
      sum += abs(q[j]);
      if (j > 0) quotient[j - 1] = remainder;
    }
    if (abs(remainder) > rounding * sum) return;
    q.swap(quotient);
    found.emplace_back(-1.0L);
  }
}

/// Continues the iteration in a hundred digits. Extended precision does not resolve the zeros of a cluster one by one,
/// and their product would not be that of q.
void settle(const ExactPolynomial& q, std::vector<Complex>& s) {
  struct Pair {
    Exact real, imag;
    Pair operator-(const Pair& b) const { return {real - b.real, imag - b.imag}; }
    Pair operator+(const Pair& b) const { return {real + b.real, imag + b.imag}; }
    Pair operator*(const Pair& b) const { return {real * b.real - imag * b.imag, real * b.imag + imag * b.real}; }
    Complex rounded() const { return {real.convert_to<long double>(), imag.convert_to<long double>()}; }
  };
  constexpr long double kSettled = 1e-9L;  // relative change of a distance by a step: the next is its cube
  std::vector<Pair> found;
  found.reserve(s.size());
  for (const Complex& zero : s) found.push_back({Exact(zero.real()), Exact(zero.imag())});
  std::vector<bool> done(s.size(), false);
  for (int iteration = 0; iteration < 60 && std::find(done.begin(), done.end(), false) != done.end(); ++iteration) {
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (done[i]) continue;
      Pair value{0, 0}, slope{0, 0};
      for (std::size_t j = q.size(); j-- > 0;) {
        slope = slope * found[i] + value;
        value = value * found[i];
        value.real += q[j];
      }
      const Exact size = slope.real * slope.real + slope.imag * slope.imag;
      done[i] = size == 0 || (value.real == 0 && value.imag == 0);
      if (done[i]) continue;
      const Pair quotient = value * Pair{slope.real / size, -slope.imag / size};
      Complex repulsion = 0.0L;
      for (std::size_t j = 0; j < found.size(); ++j) {
        const Complex apart = j == i ? 0.0L : (found[i] - found[j]).rounded();
        if (apart != 0.0L) repulsion += 1.0L / apart;
      }
      const Complex newton = quotient.rounded(), factor = 1.0L / (1.0L - newton * repulsion);
      if (!std::isfinite(factor.real()) || !std::isfinite(factor.imag())) continue;
      found[i] = found[i] - quotient * Pair{Exact(factor.real()), Exact(factor.imag())};
      done[i] = std::abs(newton * factor) * (std::abs(repulsion) + 1.0L / std::abs(s[i])) <= kSettled;
    }
  }
  for (std::size_t i = 0; i < s.size(); ++i) s[i] = found[i].rounded();
}

/// Adds the zeros of a real polynomial to `found`, conjugates beside each other.
void add_in_pairs(std::vector<Complex> s, std::vector<Complex>& found) {
  while (!s.empty()) {
    const Complex zero = s.back();
    const auto distance = [&zero](const Complex& other) { return std::norm(other - std::conj(zero)); };
    const auto partner = std::min_element(
        s.begin(), s.end(), [&distance](const Complex& a, const Complex& b) { return distance(a) < distance(b); });
    const bool alone = distance(*partner) >= distance(zero);
    found.push_back(alone ? Complex(zero.real()) : zero);
    if (!alone) {
      found.push_back(*partner);
      s.erase(partner);
    }
    s.pop_back();
  }
}

}  // namespace

std::vector<std::complex<long double>> zeros(const ExactPolynomial& p, long double rounding) {
  constexpr long double kResolved = 1e-15L;
  ExactPolynomial q = p;
  while (q.size() > 1 && q.back() == 0) q.pop_back();
  std::vector<Complex> found;
  while (q.size() > 1 && q.front() == 0) {
    q.erase(q.begin());
    found.emplace_back(0.0L);
  }
  deflate_at_origin_of_z(q, rounding, found);
  if (q.size() < 2) return found;
  const DeltaPolynomial extended = rounded_delta(q);
  std::vector<Complex> s = starts_of(extended);
  const long double doubt = iterate(s, [&extended](Complex at) { return newton_step(extended, at); });
  if (!(doubt < kResolved)) settle(q, s);
  add_in_pairs(std::move(s), found);
  return found;
}

std::vector<std::complex<long double>> zeros_behind_delay(const ExactPolynomial& a, std::size_t delay,
                                                          const ExactPolynomial& b) {
  const DeltaPolynomial first = rounded_delta(a), second = rounded_delta(b);
  // In powers of z, where the delay only moves coefficients: in powers of s, the digits of 3^delay would cancel.
  const auto ascending = [](const ExactPolynomial& p) {
    const ExactPolynomial of_z = shifted_to_origin(p);
    return ExactPolynomial(of_z.rbegin(), of_z.rend());
  };
  ExactPolynomial delayed = ascending(a);
  delayed.insert(delayed.begin(), delay, Exact(0));
  const ExactPolynomial expanded = add(std::move(delayed), ascending(b));
  constexpr std::size_t kMostEigenvalues = 500;  // the time for them grows like the cube of their number
  std::vector<Complex> s;
  if (expanded.size() <= kMostEigenvalues) {
    for (const std::complex<double>& z : roots(rounded(expanded).reverse())) s.emplace_back(z);
  } else {
    s = starts_of(rounded_delta(expanded));
  }
  for (Complex& z : s) z -= 1.0L;
  struct Value {
    Complex value = 0.0L, slope = 0.0L;
    long double size = 0.0L;  ///< sum of the moduli of the terms
  };
  const auto rated = [](const DeltaPolynomial& p, Complex at) {
    Value result;
    const long double length = std::abs(at);
    for (auto c = p.rbegin(); c != p.rend(); ++c) {
      result.slope = result.slope * at + result.value;
      result.value = result.value * at + *c;
      result.size = result.size * length + std::abs(*c);
    }
    return result;
  };
  iterate(s, [&](Complex at) -> NewtonStep {
    const Value p = rated(first, at), q = rated(second, at);
    const Complex z = 1.0L + at, before = delay > 0 ? power(z, delay - 1) : 0.0L,
                  passed = delay > 0 ? before * z : 1.0L;
    const Complex value = p.value * passed + q.value;
    const Complex slope = p.slope * passed + static_cast<long double>(delay) * before * p.value + q.slope;
    if (std::abs(value) <= 4.0L * kUnit * (p.size * std::abs(passed) + q.size)) return {0.0L, true, 0.0L};
    return {value / slope, false, 0.0L};
  });
  return s;
}

}  // namespace platoon
