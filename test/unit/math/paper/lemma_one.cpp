#include "unit/math/paper/lemma_one.hpp"

#include <Eigen/LU>
#include <stdexcept>
#include <string>

#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/numerics/eigenvalues.hpp"
#include "stochastic_platoon/math/numerics/interruption.hpp"

namespace platoon {

namespace {

Eigen::MatrixXd kronecker(const Eigen::MatrixXd& left, const Eigen::MatrixXd& right) {
  Eigen::MatrixXd product(left.rows() * right.rows(), left.cols() * right.cols());
  for (Eigen::Index i = 0; i < left.rows(); ++i) {
    for (Eigen::Index j = 0; j < left.cols(); ++j) {
      product.block(i * right.rows(), j * right.cols(), right.rows(), right.cols()) = left(i, j) * right;
    }
  }
  return product;
}

}  // namespace

Eigen::MatrixXd noise_covariance(const StringMatrices& string, double noise_variance) {
  const Eigen::MatrixXd cross = string.a * string.b_a * string.b_b.transpose();
  return noise_variance *
         (string.b_a * string.b_a.transpose() + string.b_b * string.b_b.transpose() + cross + cross.transpose());
}

SignalMoments error_moments_by_lemma_one(const PlatoonModel& model, std::size_t followers, std::int64_t steps) {
  const std::vector<double> leader = leader_error(model, steps);
  const StringMatrices string =
      string_matrices(model.default_vehicle().loop.realization, model.default_vehicle().headway, followers);
  const InitialString initial = initial_string(model, followers);
  const Eigen::MatrixXd first = model.default_vehicle().position().noise_variance * string.b_a * string.b_a.transpose();
  const Eigen::MatrixXd later = noise_covariance(string, model.default_vehicle().position().noise_variance);
  Eigen::VectorXd mean = initial.mean;
  Eigen::MatrixXd covariance = initial.covariance;
  const auto count = static_cast<std::size_t>(steps);
  SignalMoments moments{steps, followers, std::vector<double>(followers * count),
                        std::vector<double>(followers * count)};
  for (std::size_t k = 0; k < count; ++k) {
    check_interruption();
    const Eigen::VectorXd errors = string.c * mean;
    const Eigen::MatrixXd error_covariance = string.c * covariance * string.c.transpose();
    for (std::size_t i = 0; i < followers; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      moments.mean[i * count + k] = errors(row);
      moments.variance[i * count + k] = error_covariance(row, row);
    }
    mean = (string.a * mean + string.b_o * leader[k]).eval();
    covariance = (string.a * covariance * string.a.transpose() + (k == 0 ? first : later)).eval();
  }
  return moments;
}

Eigen::MatrixXd stationary_covariance_by_vec(const StringMatrices& string, double noise_variance) {
  const Eigen::Index n = string.c.cols() / string.c.rows();
  if (!(spectral_radius(string.a.topLeftCorner(n, n)) < 1.0)) throw std::invalid_argument("rho(A): must be < 1");
  const Eigen::MatrixXd upsilon = noise_covariance(string, noise_variance);
  const Eigen::Index size = upsilon.size();
  const Eigen::MatrixXd map = Eigen::MatrixXd::Identity(size, size) - kronecker(string.a, string.a);
  const Eigen::VectorXd vec = Eigen::Map<const Eigen::VectorXd>(upsilon.data(), size);
  const Eigen::VectorXd solution = map.partialPivLu().solve(vec);
  const Eigen::VectorXd errors = kronecker(string.c, string.c) * solution;
  return Eigen::Map<const Eigen::MatrixXd>(errors.data(), string.c.rows(), string.c.rows());
}

Eigen::MatrixXd stationary_covariance_by_lyapunov(const StringMatrices& string, double noise_variance) {
  const Eigen::MatrixXd covariance = solve_discrete_lyapunov(string.a, noise_covariance(string, noise_variance));
  return string.c * covariance * string.c.transpose();
}

}  // namespace platoon
