#include "stochastic_platoon/math/numerics/circle_polynomial.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>

namespace platoon {

namespace {

/// The sign change of p between a and b, where p(a) and p(b) have opposite signs, by bisection.
long double bisect(const CirclePolynomial& p, long double a, long double b) {
  const bool rising = evaluate(p, a) < 0.0L;
  for (;;) {
    const long double middle = a + (b - a) / 2.0L;
    if (middle <= a || middle >= b) return middle;
    ((evaluate(p, middle) < 0.0L) == rising ? a : b) = middle;
  }
}

void add_scaled(CirclePolynomial& sum, const CirclePolynomial& p, long double factor, std::size_t shift) {
  if (sum.size() < p.size() + shift) sum.resize(p.size() + shift, 0.0L);
  for (std::size_t i = 0; i < p.size(); ++i) sum[i + shift] += factor * p[i];
}

}  // namespace

Centre nearest(long double frequency) {
  return frequency < 1.5707963267948966L ? Centre::kOne : Centre::kMinusOne;
}

CirclePoint::CirclePoint(long double w) : frequency(static_cast<double>(w)), centre(nearest(w)) {
  const long double half = w / 2.0L, sine = std::sin(half), cosine = std::cos(half);
  offset = {centre == Centre::kOne ? -2.0L * sine * sine : 2.0L * cosine * cosine, 2.0L * sine * cosine};
}

long double circle_coordinate(long double frequency, Centre centre) {
  const long double half_angle = frequency / 2.0L;
  const long double s = centre == Centre::kOne ? std::sin(half_angle) : std::cos(half_angle);
  return 2.0L * s * s;
}

double frequency_at(long double t, Centre centre) {
  const long double root = std::sqrt(std::min(std::max(t / 2.0L, 0.0L), 1.0L));
  return static_cast<double>(2.0L * (centre == Centre::kOne ? std::asin(root) : std::acos(root)));
}

CirclePolynomial recentred(CirclePolynomial b) {
  const std::size_t n = b.size();
  for (std::size_t j = 0; j + 1 < n; ++j) {
    for (std::size_t i = n - 1; i-- > j;) b[i] -= 2.0L * b[i + 1];
  }
  return b;
}

CirclePolynomial squared_modulus(const CirclePolynomial& b, Centre centre) {
  const long double sum_of_pair = centre == Centre::kOne ? -2.0L : 2.0L;  // u + conj u, over t
  CirclePolynomial result(1, 0.0L);
  CirclePolynomial power_sum{1.0L};  // s_0 / 2, so that pairs i = j count once
  CirclePolynomial before;
  for (std::size_t k = 0; k < b.size(); ++k) {
    long double scale = 1.0L;
    for (std::size_t i = 0; i + k < b.size(); ++i, scale *= 2.0L) {
      add_scaled(result, power_sum, b[i] * b[i + k] * scale, i);
    }
    CirclePolynomial next(1, 0.0L);
    add_scaled(next, power_sum, sum_of_pair, 1);
    add_scaled(next, before, k == 1 ? -4.0L : -2.0L, 1);
    before = power_sum;
    power_sum = next;
  }
  return result;
}

long double evaluate(const CirclePolynomial& p, long double t) {
  long double value = 0.0L;
  for (std::size_t i = p.size(); i-- > 0;) value = value * t + p[i];
  return value;
}

long double squared_modulus_at(const CirclePolynomial& b, Centre centre, long double t) {
  const long double pair_sum = centre == Centre::kOne ? -2.0L * t : 2.0L * t;  // u + conj u
  const long double pair_product = 2.0L * t;                                   // |u|^2
  long double next = 0.0L;
  long double current = 0.0L;
  for (std::size_t j = b.size(); j-- > 1;) {
    const long double value = b[j] + pair_sum * current - pair_product * next;
    next = current;
    current = value;
  }
  const long double constant = b[0] - pair_product * next;  // P = constant + u current
  return constant * constant + constant * current * pair_sum + current * current * pair_product;
}

std::complex<long double> power(std::complex<long double> z, std::size_t n) {
  std::complex<long double> product = 1.0L;
  for (; n > 0; n /= 2) {
    if (n % 2 == 1) product *= z;
    z *= z;
  }
  return product;
}

std::complex<long double> turned(std::complex<long double> z, std::int64_t n) {
  return power(n < 0 ? std::conj(z) : z, static_cast<std::size_t>(std::abs(n)));
}

long double magnitude(const CirclePolynomial& p, long double t) {
  long double value = 0.0L;
  for (std::size_t i = p.size(); i-- > 0;) value = value * std::abs(t) + std::abs(p[i]);
  return value;
}

CirclePolynomial derivative(const CirclePolynomial& p) {
  CirclePolynomial slope(std::max<std::size_t>(p.size(), 2) - 1, 0.0L);
  for (std::size_t i = 1; i < p.size(); ++i) slope[i - 1] = static_cast<long double>(i) * p[i];
  return slope;
}

CirclePolynomial multiply(const CirclePolynomial& p, const CirclePolynomial& q) {
  CirclePolynomial product;
  for (std::size_t i = 0; i < p.size(); ++i) add_scaled(product, q, p[i], i);
  return product;
}

CirclePolynomial subtract(const CirclePolynomial& p, const CirclePolynomial& q) {
  CirclePolynomial result = p;
  add_scaled(result, q, -1.0L, 0);
  return result;
}

int leading_zeros(const CirclePolynomial& p, const CirclePolynomial& sizes, int known) {
  auto j = static_cast<std::size_t>(known);
  while (j < p.size() && std::abs(p[j]) <= kCoefficientRounding * sizes[j]) ++j;
  return static_cast<int>(j);
}

CirclePolynomial without_zero_at_origin(const CirclePolynomial& p) {
  if (p.size() < 2) return CirclePolynomial(1, 0.0L);
  return CirclePolynomial(p.begin() + 1, p.end());
}

std::vector<long double> sign_changes(const CirclePolynomial& p, long double from, long double to) {
  CirclePolynomial trimmed = p;
  while (trimmed.size() > 1 && trimmed.back() == 0.0L) trimmed.pop_back();
  if (trimmed.size() < 2) return {};
  std::vector<long double> ends = sign_changes(derivative(trimmed), from, to);
  ends.push_back(to);
  std::vector<long double> found;
  long double a = from;
  long double value = evaluate(trimmed, a);
  for (const long double b : ends) {
    const long double next = evaluate(trimmed, b);
    if (value == 0.0L) {  // a zero at the start of the piece: compare with the sign beyond it
      value = next;
    } else if (next == 0.0L && b < to) {
      continue;  // p touches or crosses zero at b: the next piece decides
    } else if ((value < 0.0L) != (next < 0.0L) && next != 0.0L) {
      found.push_back(bisect(trimmed, a, b));
      value = next;
    }
    a = b;
  }
  return found;
}

}  // namespace platoon
