#pragma once

#include <complex>
#include <vector>

#include "stochastic_platoon/math/numerics/quadrature.hpp"

namespace platoon {

/// Factors that integrate f(nu) y / (1 - y), y = lambda e^{j (nu - w)}, over the panels of a rule that resolves f
/// alone, for abs(lambda) arbitrarily near to 1, lambda complex: the sum over a panel's nodes of weight, f and factor
/// is exact for polynomials f of degree 15 (product integration; the integral of P_l(x) / (z - x) over [-1, 1] is 2
/// Q_l(z), Q_l the Legendre function of the second kind).
class MemoryWeights {
public:
  /// A half_circle_quadrature(), which must outlive the object. 0 < abs(memory) < 1, memory = lambda.
  MemoryWeights(const Quadrature& rule, std::complex<double> memory);

  /// The factors at all nodes nu, for w in [-pi, pi]. Those at -nu are the conjugates of the ones at nu for -w and the
  /// conjugate of lambda.
  std::vector<std::complex<double>> at(long double w) const;

private:
  const Quadrature& rule_;
  double turn_;                                   ///< the argument of lambda
  double decay_;                                  ///< -ln abs(lambda)
  std::vector<std::complex<double>> remembered_;  ///< lambda e^{j nu}
};

}  // namespace platoon
