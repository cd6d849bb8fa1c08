#pragma once

#include <Eigen/Core>

namespace platoon {

/// Of a square matrix, in no particular order.
Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& matrix);

/// The largest eigenvalue's modulus.
double spectral_radius(const Eigen::MatrixXd& matrix);

}  // namespace platoon
