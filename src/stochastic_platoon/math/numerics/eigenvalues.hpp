#pragma once

#include <Eigen/Core>

namespace platoon {

/// Eigenvalues of a square matrix, in no particular order.
Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& matrix);

/// The largest modulus of an eigenvalue.
double spectral_radius(const Eigen::MatrixXd& matrix);

}  // namespace platoon
