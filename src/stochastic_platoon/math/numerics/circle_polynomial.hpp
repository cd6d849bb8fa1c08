#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace platoon {

/// Real polynomial in t by ascending powers, p(t) = p[0] + p[1] t + ... Extended precision keeps its rounding below
/// that of the coefficients it was computed from. Also by powers of z - 1 or z + 1, as DeltaPolynomial, the same type.
using CirclePolynomial = std::vector<long double>;

/// Centre of an expansion on the unit circle, used for the half of the circle near it: there t <= 1 and nothing
/// cancels.
enum class Centre {
  kOne,       ///< z = 1:  t = 1 - cos w
  kMinusOne,  ///< z = -1: t = 1 + cos w
};

/// The centre nearer to e^{jw}.
Centre nearest(long double frequency);

/// t = 1 - cos w about z = 1, 1 + cos w about z = -1, without cancellation.
long double circle_coordinate(long double frequency, Centre centre);

/// A point e^{jw} of the unit circle by its offset from the nearer of 1 and -1, without cancellation.
struct CirclePoint {
  explicit CirclePoint(long double w);

  /// e^{jw} - 1, of the digits of the offset.
  std::complex<long double> from_one() const { return centre == Centre::kOne ? offset : offset - 2.0L; }

  double frequency;
  Centre centre;
  std::complex<long double> offset;
};

/// The w in [0, pi] of a t.
double frequency_at(long double t, Centre centre);

/// Relative error bound of a coefficient that was computed from the numbers of a model.
constexpr double kCoefficientRounding = 32.0 * std::numeric_limits<double>::epsilon();

/// Taylor coefficients about z = -1 of the polynomial that has the coefficients b_j about z = 1.
CirclePolynomial recentred(CirclePolynomial b);

/// |P(e^{jw})|^2 as a polynomial in t, from the Taylor coefficients b_j of P about the centre:
/// \f[ \sum_i b_i^2 (2t)^i + \sum_{i<j} b_i b_j (2t)^i s_{j-i}(t), \f]
/// with u = z - c and s_k = u^k + conj(u)^k = (u + conj u) s_{k-1} - |u|^2 s_{k-2}; both factors are +-2 t.
CirclePolynomial squared_modulus(const CirclePolynomial& b, Centre centre);

/// |P(e^{jw})|^2 at one t from the Taylor coefficients b_j, squared only at the end: accurate to the rounding of |P|
/// even near a zero of P, where the polynomial in t cancels. Uses Clenshaw's recurrence for u and conj u.
long double squared_modulus_at(const CirclePolynomial& b, Centre centre, long double t);

/// p(t) by Horner's rule.
long double evaluate(const CirclePolynomial& p, long double t);

/// p(s) by Horner's rule, without the infinity handling of std::complex, which is slow.
inline std::complex<long double> evaluate(const CirclePolynomial& p, std::complex<long double> s) {
  long double real = 0.0L, imag = 0.0L;
  for (auto c = p.rbegin(); c != p.rend(); ++c) {
    const long double next = real * s.real() - imag * s.imag() + *c;
    imag = real * s.imag() + imag * s.real();
    real = next;
  }
  return {real, imag};
}

/// z^n by squaring.
std::complex<long double> power(std::complex<long double> z, std::size_t n);

/// z^n, n of either sign, on the unit circle.
std::complex<long double> turned(std::complex<long double> z, std::int64_t n);

/// sum_i |p_i| |t|^i, the scale of the rounding error of p(t).
long double magnitude(const CirclePolynomial& p, long double t);

CirclePolynomial derivative(const CirclePolynomial& p);
CirclePolynomial multiply(const CirclePolynomial& p, const CirclePolynomial& q);
CirclePolynomial subtract(const CirclePolynomial& p, const CirclePolynomial& q);

/// p(t) / t; assumes p(0) = 0 without checking. The zero polynomial if p is constant.
CirclePolynomial without_zero_at_origin(const CirclePolynomial& p);

/// Number of lowest coefficients that are zero to the rounding of the sums they result from, whose terms have these
/// moduli; at least `known`.
int leading_zeros(const CirclePolynomial& p, const CirclePolynomial& sizes, int known);

/// The places in the open interval (from, to) where p changes sign, in ascending order and to the last digit. The
/// search runs recursively between the sign changes of dp/dt, without a grid: it misses none.
std::vector<long double> sign_changes(const CirclePolynomial& p, long double from, long double to);

}  // namespace platoon
