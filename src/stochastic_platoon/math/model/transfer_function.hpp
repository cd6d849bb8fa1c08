#pragma once

#include <complex>

#include "stochastic_platoon/math/numerics/polynomial.hpp"

namespace platoon {

/// Rational function N(z) / D(z) with real coefficients.
///
/// Valid by construction: both polynomials are trimmed and finite, D is not zero and is made monic. Throws
/// std::invalid_argument where that cannot be.
class TransferFunction {
public:
  TransferFunction(const Polynomial& numerator, const Polynomial& denominator);

  const Polynomial& numerator() const { return numerator_; }
  const Polynomial& denominator() const { return denominator_; }

  /// Degree of the denominator minus degree of the numerator; for N = 0 the degree of D plus one.
  int relative_degree() const;
  bool is_strictly_proper() const { return relative_degree() > 0; }

  /// N(z) / D(z); infinite or NaN at a pole.
  std::complex<double> operator()(std::complex<double> z) const;

private:
  Polynomial numerator_;
  Polynomial denominator_;
};

/// A fraction in lowest terms and the factor it was reduced by.
struct Reduction {
  TransferFunction minimal;
  Polynomial common_factor;  ///< monic; [1] when nothing cancels
};

/// Cancels the common zeros of numerator and denominator of a fraction of any relative degree >= 0; of an
/// improper one only those at z = 0.
///
/// What is cancelled is common to rounding: the fraction found, times the factor, has the coefficients that
/// were given to 32 units in the last place of the largest, and its values on the unit circle agree. Zeros at
/// z = 0 are cancelled exactly. The others are found without computing zeros, which are
/// ill-conditioned where they are multiple: N/D = u/v with deg v < deg D exists just when the Sylvester-type
/// matrix of the map (v, u) -> N v - D u is singular; the smallest such v is taken from its null vector.
/// Singular means: the last pivot of a QR decomposition below 10 `tolerance` times the first, for N and D
/// scaled to unit norm.
Reduction reduce(const TransferFunction& fraction, double tolerance = 1e-13);

/// H(z) = (1 + h) - h / z, the feedback path of the constant headway policy (paper, section 3). h in sample
/// periods.
TransferFunction headway_policy(double headway);

/// G(z) K(z).
TransferFunction series(const TransferFunction& first, const TransferFunction& second);

/// F / (1 + F R), not reduced. Throws std::invalid_argument when 1 + F R is identically zero.
TransferFunction feedback(const TransferFunction& forward, const TransferFunction& return_path);

}  // namespace platoon
