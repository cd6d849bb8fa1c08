#pragma once

#include <complex>

#include "stochastic_platoon/math/numerics/polynomial.hpp"

namespace platoon {

/// Rational function N(z) / D(z) with real coefficients.
///
/// Valid by construction: both polynomials are trimmed and finite, D is not zero and is made monic. Throws
/// std::invalid_argument otherwise.
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

/// A fraction in lowest terms and the factor that was cancelled.
struct Reduction {
  TransferFunction minimal;
  Polynomial common_factor;  ///< monic; [1] if nothing cancels
};

/// Cancels the common zeros of numerator and denominator of a fraction of any relative degree >= 0; for an improper
/// fraction only those at z = 0.
///
/// A cancelled factor is common to rounding: the reduced fraction times the factor has the given coefficients to 32
/// units in the last place of the largest, and the values on the unit circle agree. Zeros at z = 0 are cancelled
/// exactly. The others are found without computing zeros, which are ill-conditioned if they are multiple: N/D = u/v
/// with deg v < deg D exists exactly if the Sylvester-type matrix of the map (v, u) -> N v - D u is singular; the v of
/// smallest degree follows from its null vector. The matrix counts as singular if the last pivot of its QR
/// decomposition is below 1e-12 times the first, for N and D scaled to unit norm.
Reduction reduce(const TransferFunction& fraction);

/// \f$ H(z) = (1 + h) - h / z \f$, the feedback path of the constant headway policy (paper, section 3). h in sample
/// periods.
TransferFunction headway_policy(double headway);

/// G(z) K(z).
TransferFunction series(const TransferFunction& first, const TransferFunction& second);

/// F / (1 + F R), not reduced. Throws std::invalid_argument if 1 + F R is identically zero.
TransferFunction feedback(const TransferFunction& forward, const TransferFunction& return_path);

}  // namespace platoon
