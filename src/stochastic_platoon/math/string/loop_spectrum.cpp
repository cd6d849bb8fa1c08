#include "stochastic_platoon/math/string/loop_spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace platoon {

namespace {

/// z D - ((1+h) z - h) N by Taylor coefficients about z = 1.
CirclePolynomial sensitivity_taylor(const CirclePolynomial& n, const CirclePolynomial& d, double headway) {
  const auto at = [](const CirclePolynomial& p, std::size_t i) { return i < p.size() ? p[i] : 0.0L; };
  const long double h = headway;
  CirclePolynomial s{at(d, 0) - at(n, 0)};
  for (std::size_t j = 1; j <= d.size(); ++j) {
    s.push_back(at(d, j) + at(d, j - 1) - at(n, j) - (1.0L + h) * at(n, j - 1));
  }
  return s;
}

LoopSpectrumHalf half(const CirclePolynomial& numerator, const CirclePolynomial& denominator,
                      const CirclePolynomial& sensitivity, const CirclePolynomial& factor, Centre centre) {
  LoopSpectrumHalf result;
  result.numerator = numerator;
  result.denominator = denominator;
  result.sensitivity = sensitivity;
  result.sensitivity_factor = factor;
  result.margin = subtract(squared_modulus(denominator, centre), squared_modulus(numerator, centre));
  result.stripped_margin = result.margin;
  return result;
}

/// Whether s, the coefficients of z D - ((1+h) z - h) N by powers of z - 1, begins with two zeros, to the accuracy of
/// violated_assumptions().
bool has_two_zeros(const CirclePolynomial& s, const CirclePolynomial& d, double headway) {
  if (s.size() < 3 || d.size() < 2) return false;
  const long double size = std::abs(d[0]);
  return std::abs(s[0]) <= 2e-4L * size && std::abs(s[1]) <= 2e-4L * std::abs(d[1]) + 2e-3L * (1.0L + headway) * size;
}

/// The more accurate of p(t) and `other`, which are equal in exact arithmetic.
long double surer(const CirclePolynomial& p, long double t, long double other, long double other_magnitude) {
  return magnitude(p, t) <= other_magnitude ? evaluate(p, t) : other;
}

}  // namespace

std::vector<std::complex<double>> frequencies_of(const std::vector<std::complex<long double>>& places) {
  std::vector<std::complex<double>> frequencies;
  for (const std::complex<long double>& s : places) {
    const long double excess = modulus_minus_one(s);
    if (excess <= -1.0L) continue;  // z = 0 is infinitely far from the circle
    frequencies.emplace_back(static_cast<double>(std::arg(1.0L + s)), static_cast<double>(-std::log1p(excess)));
  }
  return frequencies;
}

std::vector<std::complex<double>> singular_frequencies(const DeltaPolynomial& denominator) {
  return frequencies_of(zeros(denominator));
}

LoopSpectrum::LoopSpectrum(const ClosedLoop& loop, double headway) : headway_(headway) {
  if (!(headway > 0.0) || !std::isfinite(headway)) {
    throw std::invalid_argument("time_headway: " + std::to_string(headway) + ": must be finite and > 0");
  }
  const DeltaFraction t = delta_fraction(loop);
  const CirclePolynomial s = sensitivity_taylor(t.numerator, t.denominator, headway);
  if (!has_two_zeros(s, t.denominator, headway)) {
    throw std::invalid_argument("S(z): has fewer than two zeros at z = 1: G(z) K(z) must have two poles there");
  }
  numerator_ = z_form(t.numerator);
  denominator_ = z_form(t.denominator);
  const CirclePolynomial q(s.begin() + 2, s.end());
  near_ = half(t.numerator, t.denominator, s, q, Centre::kOne);
  far_ = half(recentred(t.numerator), recentred(t.denominator), recentred(s), recentred(q), Centre::kMinusOne);
  near_.stripped_margin = without_zero_at_origin(near_.margin);
  strip_flat_zeros();
}

void LoopSpectrum::strip_flat_zeros() {
  while (near_.stripped_margin.size() > 1 && std::abs(near_.stripped_margin.front()) <= margin_uncertainty(0.0)) {
    near_.stripped_margin = without_zero_at_origin(near_.stripped_margin);
    ++margin_zeros_;
  }
  const CirclePolynomial& q = near_.sensitivity_factor;
  long double scale = 0.0L;
  for (const long double b : q) scale += std::abs(b);
  for (std::size_t j = 0; j + 1 < q.size() && std::abs(q[j]) <= kCoefficientRounding * scale; ++j) ++sensitivity_zeros_;
}

double LoopSpectrum::margin_uncertainty(double frequency) const {
  // A change of d_k that keeps T(1) = 1 moves D by d_k (z^k - 1 - ...), bounded by powers of k t and by 1.
  const std::complex<double> z = std::polar(1.0, frequency);
  const auto t = static_cast<double>(circle_coordinate(frequency, Centre::kOne));
  const auto spread = [&](const Polynomial& p) {
    double sum = 0.0;
    for (Eigen::Index i = 0; i < p.size(); ++i) {
      const auto power = static_cast<double>(std::max<Eigen::Index>(p.size() - 1 - i, 1));
      const double divided = t > 0.0 ? std::min(power * power, 1.0 / t) : power * power;
      sum += std::abs(p(i)) * (nearest(frequency) == Centre::kOne ? std::pow(divided, margin_zeros_) : 1.0);
    }
    return sum * std::abs(evaluate(p, z));
  };
  return kCoefficientRounding * (spread(numerator_) + spread(denominator_));
}

LoopSpectrumValue LoopSpectrum::at(double frequency) const {
  const Centre centre = nearest(frequency);
  const LoopSpectrumHalf& part = about(centre);
  const long double t = circle_coordinate(frequency, centre);
  const long double x = circle_coordinate(frequency, Centre::kOne);
  const auto modulus = [&](const CirclePolynomial& p) { return squared_modulus_at(p, centre, t); };
  const long double d = modulus(part.denominator);
  const long double n = modulus(part.numerator);
  const long double size = std::sqrt(2.0L * t);  // |z - centre|
  const long double doubt =
      2.0L * (std::sqrt(d) * magnitude(part.denominator, size) + std::sqrt(n) * magnitude(part.numerator, size));
  const long double margin = surer(part.margin, t, d - n, doubt);
  const long double divisor = centre == Centre::kOne ? std::pow(x, margin_zeros_) : 1.0L;
  const long double offset = centre == Centre::kOne ? part.margin.front() : 0.0L;  // rounding of T(1) = 1
  const long double stripped = surer(part.stripped_margin, t, (d - n - offset) / divisor, doubt / divisor);
  const long double zeros_left = std::pow(x, 2 - (centre == Centre::kOne ? margin_zeros_ : 0));
  const long double ratio = 4.0L * zeros_left * modulus(part.sensitivity_factor) / stripped;
  const long double h = headway_;
  return {static_cast<double>(n / d),
          static_cast<double>(margin / d),
          static_cast<double>(stripped * divisor / d),
          static_cast<double>(modulus(part.sensitivity) / d),
          static_cast<double>((1.0L + 2.0L * h * (1.0L + h) * x) * n / d),
          static_cast<double>(ratio)};
}

std::vector<std::complex<double>> LoopSpectrum::pole_frequencies() const {
  return singular_frequencies(near_.denominator);
}

std::vector<std::complex<double>> LoopSpectrum::margin_roots() const {
  const std::vector<std::complex<long double>> found = zeros(near_.stripped_margin);
  return {found.begin(), found.end()};
}

}  // namespace platoon
