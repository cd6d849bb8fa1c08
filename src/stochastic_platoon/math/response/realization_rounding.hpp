#pragma once

#include <vector>

#include "stochastic_platoon/math/model/state_space.hpp"
#include "stochastic_platoon/math/numerics/circle_polynomial.hpp"

namespace platoon {

/// How far the rounding of given A, B and C may move ln |T / T(1)|.
///
/// With the rows x = C (zI - A)^-1 and the columns y = (zI - A)^-1 B, relative changes alpha of the entries of A, beta
/// of B and gamma of C change ln T, to first order, by
/// \f[ \sum_{ij} \alpha_{ij} g_{ij} + \sum_j \beta_j g_j + \sum_i \gamma_i g_i, \qquad
///     g_{ij} = x_i a_{ij} y_j / T, \quad g_j = x_j b_j / T, \quad g_i = c_i y_i / T. \f]
class RealizationRounding {
public:
  RealizationRounding(const StateSpace& system, const Resolvent& resolvent);

  /// Bound of the change of ln |T / T(1)|^2 at the point if every entry changes by its rounding to double: the machine
  /// epsilon times the sum of |Re g(z) - g(1)|. Infinite at a zero of T.
  double at(const CirclePoint& point) const;

private:
  struct Half {
    std::vector<CirclePolynomial> outputs, states;
    CirclePolynomial numerator, denominator;
  };
  /// The real parts of all g.
  std::vector<long double> sensitivities(const Half& half, std::complex<long double> offset) const;

  StateSpace system_;
  Half near_, far_;  ///< about 1 and -1
  std::vector<long double> at_one_;
};

}  // namespace platoon
