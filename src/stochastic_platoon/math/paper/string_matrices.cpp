#include "stochastic_platoon/math/paper/string_matrices.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#include "stochastic_platoon/math/model/platoon_model.hpp"

namespace platoon {

StringMatrices string_matrices(const StateSpace& vehicle, double headway, std::size_t followers) {
  if (followers < 1) throw std::invalid_argument("followers: 0: must be >= 1");
  if (!(headway > 0.0) || !std::isfinite(headway)) {
    throw std::invalid_argument("time_headway: " + std::to_string(headway) + ": must be finite and > 0");
  }
  const Eigen::Index n = vehicle.order();
  const auto count = static_cast<Eigen::Index>(followers);
  StringMatrices string{Eigen::MatrixXd::Zero(n * count, n * count), Eigen::VectorXd::Zero(n * count),
                        Eigen::MatrixXd::Zero(n * count, count), Eigen::MatrixXd::Zero(n * count, count),
                        Eigen::MatrixXd::Zero(count, n * count)};
  string.b_o.head(n) = vehicle.b();
  for (Eigen::Index i = 0; i < count; ++i) {
    string.a.block(i * n, i * n, n, n) = vehicle.a();
    string.b_a.block(i * n, i, n, 1) = -(1.0 + headway) * vehicle.b();
    string.b_b.block(i * n, i, n, 1) = headway * vehicle.b();
    string.c.block(i, i * n, 1, n) = vehicle.c();
    if (i == 0) continue;
    string.a.block(i * n, (i - 1) * n, n, n) = vehicle.b() * vehicle.c();
    string.b_a.block(i * n, i - 1, n, 1) = vehicle.b();
  }
  return string;
}

InitialString initial_string(const PlatoonModel& model, std::size_t followers) {
  if (followers < 1) throw std::invalid_argument("followers: 0: must be >= 1");
  const StateSpace& vehicle = model.default_vehicle().loop.realization;
  const double h = model.default_vehicle().headway;
  const Eigen::Index n = vehicle.order();
  const auto count = static_cast<Eigen::Index>(followers);
  const Eigen::VectorXd equilibrium = unit_equilibrium(vehicle);
  const Eigen::VectorXd left = vehicle.a() * equilibrium;
  InitialString initial;
  initial.response = Eigen::MatrixXd::Zero(n * count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    initial.response.block(i * n, i, n, 1) = h * equilibrium - (1.0 + h) * left;
    if (i > 0) initial.response.block(i * n, i - 1, n, 1) = left - (1.0 + h) * vehicle.b();
    if (i > 1) initial.response.block(i * n, i - 2, n, 1) = vehicle.b();
  }
  initial.mean = model.default_vehicle().initial_position.mean * initial.response.rowwise().sum();
  initial.covariance =
      model.default_vehicle().initial_position.variance * initial.response * initial.response.transpose();
  return initial;
}

Eigen::MatrixXd solve_discrete_lyapunov(const Eigen::MatrixXd& a, const Eigen::MatrixXd& q) {
  if (a.rows() != a.cols() || q.rows() != a.rows() || q.cols() != a.cols()) {
    throw std::invalid_argument("A: " + std::to_string(a.rows()) + " x " + std::to_string(a.cols()) +
                                ", Q: " + std::to_string(q.rows()) + " x " + std::to_string(q.cols()) +
                                ": must be square and of the same size");
  }
  Eigen::MatrixXd power = a;
  Eigen::MatrixXd sum = q;
  for (int doubling = 0; doubling < 64; ++doubling) {
    const Eigen::MatrixXd more = power * sum * power.transpose();
    sum += more;
    if (!sum.allFinite()) break;
    if (more.cwiseAbs().maxCoeff() <= 1e-18 * sum.cwiseAbs().maxCoeff()) return sum;
    power = (power * power).eval();
  }
  // Not decided by eigenvalues: those of a long string's A are ill-conditioned.
  throw std::invalid_argument("rho(A): must be < 1 for a stationary covariance to exist");
}

}  // namespace platoon
