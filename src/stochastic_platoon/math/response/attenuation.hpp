#pragma once

#include <complex>
#include <cstddef>
#include <vector>

namespace platoon {

/// Poles and zeros of one rational factor T(z), T(1) = 1, as s = z - 1, and the multiplicity of T in a product.
struct GainFactor {
  std::vector<std::complex<long double>> poles;
  std::vector<std::complex<long double>> zeros;
  long double count = 1.0L;
  int zeros_at_one = 0;  ///< further zeros, at z = 1; each adds -ln t to the attenuation
};

/// The attenuation \f$ a(w) = -\ln \prod_i |T_i(e^{jw})|^{2 n_i} \f$ of a product of factors with T_i(1) = 1, as a
/// function of t = 1 - cos w in [0, 2]:
/// \f[ a(t) = \sum_i n_i (\sum_{poles} \ln |1 - u t| - \sum_{zeros} \ln |1 - u t|), \qquad u = -2 (1 + s) / s^2. \f]
/// The product is never multiplied out, so each vehicle's factor keeps its digits. Poles and zeros at z = 0 have
/// modulus 1 on the circle and drop out. With zeros at z = 1, a(t) is infinite at t = 0 and has no order there.
class Attenuation {
public:
  explicit Attenuation(const std::vector<GainFactor>& factors);

  struct Value {
    long double value;      ///< a(t); infinite at a zero on the circle
    long double slope;      ///< da/dt
    long double curvature;  ///< d^2 a / dt^2
  };
  Value at(long double t) const;
  /// The slope alone, without logarithms.
  long double slope(long double t) const;

  struct Minimum {
    long double t;
    long double value;  ///< a(t) / min(t, 1)^order
    bool is_global;     ///< false if most_pieces was reached: another t may be lower
  };

  /// The global minimum over [0, 2] of a(t) / min(t, 1)^order; a must vanish at least like t^order at t = 0. Branch and
  /// bound with third order Taylor bounds, without a grid, finds every minimum. Accurate to this relative accuracy or
  /// to the rounding of a.
  Minimum least(int order, long double accuracy = 1e-12L, int most_pieces = 200000) const;

  /// Coefficient of t^power, power >= 1, in the series of a about t = 0.
  long double coefficient(int power) const { return series_.at(static_cast<std::size_t>(power)); }

  /// The series converges fast for smaller t.
  long double series_end() const { return series_end_; }

  /// Whether every factor has modulus 1 at every frequency.
  bool is_zero() const { return terms_.empty(); }

private:
  struct Term {
    long double real, imag, size;  ///< of u
  };
  struct Group {  ///< the terms of one factor's poles, or of its zeros: one of each conjugate pair, or those without
    std::size_t end;
    long double weight;  ///< n of poles, -n of zeros; twice that for pairs
  };
  struct Piece;
  struct Bounds;
  Value without_zeros_at_one(long double t) const;
  Bounds bounds(const Piece& piece, int order) const;
  Bounds bounds_by_series(const Piece& piece, int order) const;
  long double quotient(long double t, int order) const;

  /// Lower bound of -zeros_at_one_ ln t over a piece by value, slope, curvature and third derivative at its centre.
  struct Logarithm {
    long double value, slope, curvature, third;
  };
  Logarithm logarithm(const Piece& piece) const;

  std::vector<Term> terms_;
  std::vector<Group> groups_;        ///< one after the other
  std::vector<long double> series_;  ///< coefficients of a by powers of t
  long double series_end_ = 0.0L;    ///< the series is used for smaller t
  long double zeros_at_one_ = 0.0L;
};

}  // namespace platoon
