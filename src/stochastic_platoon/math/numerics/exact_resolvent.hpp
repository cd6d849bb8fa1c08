#pragma once

#include <Eigen/Core>
#include <boost/multiprecision/eigen.hpp>
#include <vector>

#include "stochastic_platoon/math/numerics/exact.hpp"

namespace platoon {

using ExactMatrix = Eigen::Matrix<Exact, Eigen::Dynamic, Eigen::Dynamic>;

/// a b, entry by entry, and compiled once: Eigen's product by blocks takes seconds to compile for this number.
ExactMatrix product(const ExactMatrix& a, const ExactMatrix& b);

/// C (zI - M)^-1 by descending powers of z: the n entries of C adj(zI - M), and det(zI - M).
struct ExactResolvent {
  std::vector<ExactPolynomial> numerators;
  ExactPolynomial denominator;

  /// The numerator of C (zI - M)^-1 B.
  ExactPolynomial numerator(const ExactMatrix& b) const;
};

/// By the Faddeev-LeVerrier recursion. M is n x n, C is 1 x n.
ExactResolvent exact_resolvent(const ExactMatrix& m, const ExactMatrix& c);

}  // namespace platoon
