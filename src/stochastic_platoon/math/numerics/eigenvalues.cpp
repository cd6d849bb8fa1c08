#include "stochastic_platoon/math/numerics/eigenvalues.hpp"

#include <Eigen/Eigenvalues>

namespace platoon {

Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& matrix) {
  return matrix.eigenvalues();
}

double spectral_radius(const Eigen::MatrixXd& matrix) {
  return eigenvalues(matrix).cwiseAbs().maxCoeff();
}

}  // namespace platoon
