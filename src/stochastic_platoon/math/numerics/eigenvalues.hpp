#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

namespace platoon {

/// Eigenvalues of a square matrix, in no particular order.
Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& matrix);

/// Those of the transitions of a Markov chain, without the one nearest to 1.
std::vector<std::complex<double>> eigenvalues_beside_one(const Eigen::MatrixXd& transition);

/// The largest modulus of an eigenvalue.
double spectral_radius(const Eigen::MatrixXd& matrix);

/// An eigenvector of an eigenvalue with this modulus, which must be real.
Eigen::VectorXd leading_eigenvector(const Eigen::MatrixXd& matrix);

}  // namespace platoon
