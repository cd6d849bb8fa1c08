#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

namespace platoon {

/// A term left right / (1 - y eigenvalue) of a resolvent.
struct ResolventTerm {
  std::complex<double> eigenvalue;
  Eigen::MatrixXcd left, right;  ///< n x r and r x n
};

/// Terms of the memory of a Markov chain: with M the transposed transitions,
/// \f[ y M (I - y M)^{-1} x = \sum_m \frac{y \lambda_m}{1 - y \lambda_m} L_m R_m x, \qquad |y| \le 1, \f]
/// for all x of sum 0, so that the eigenvalue 1 does not count. A well-conditioned eigenvalue gives a term of its own.
/// A cluster of eigenvalues without accurate eigenvectors gives the terms of a Cauchy integral over a circle around it,
/// which converges geometrically (N. Higham, Functions of Matrices, 2008, section 13.3).
std::vector<ResolventTerm> memory_terms(const Eigen::MatrixXd& transposed);

}  // namespace platoon
