#include "stochastic_platoon/math/paper/string_matrices.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

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

}  // namespace platoon
