#include "stochastic_platoon/math/numerics/eigenvalues.hpp"

#include <Eigen/Eigenvalues>

namespace platoon {

Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& matrix) {
  return matrix.eigenvalues();
}

std::vector<std::complex<double>> eigenvalues_beside_one(const Eigen::MatrixXd& transition) {
  const Eigen::VectorXcd values = eigenvalues(transition);
  Eigen::Index one = 0;
  (values.array() - 1.0).abs().minCoeff(&one);
  std::vector<std::complex<double>> found;
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    if (i != one) found.push_back(values(i));
  }
  return found;
}

double spectral_radius(const Eigen::MatrixXd& matrix) {
  return eigenvalues(matrix).cwiseAbs().maxCoeff();
}

Eigen::VectorXd leading_eigenvector(const Eigen::MatrixXd& matrix) {
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(matrix);
  Eigen::Index largest = 0;
  solver.eigenvalues().cwiseAbs().maxCoeff(&largest);
  return solver.eigenvectors().col(largest).real();
}

}  // namespace platoon
