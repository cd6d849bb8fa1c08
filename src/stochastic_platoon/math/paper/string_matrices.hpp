#pragma once

#include <Eigen/Dense>
#include <cstddef>

#include "stochastic_platoon/math/model/state_space.hpp"

namespace platoon {

/// The whole string in the states xi_i(k) = x_{i-1}(k) - x_i(k) - h [x_i(k) - x_i(k-1)], paper eq. (ss_sys_all):
/// \f[ \xi(k+1) = A \xi(k) + B_o \zeta_0(k) + B_a d(k) + B_b d(k-1), \qquad \zeta(k) = C \xi(k). \f]
/// Dense, for reference and tests: N vehicles of order n take O((nN)^2) memory.
struct StringMatrices {
  Eigen::MatrixXd a;    ///< nN x nN, block lower bidiagonal: A on the diagonal, B C below
  Eigen::VectorXd b_o;  ///< nN x 1: B for the first vehicle
  Eigen::MatrixXd b_a;  ///< nN x N: -(1+h) B on the diagonal, B below
  Eigen::MatrixXd b_b;  ///< nN x N: h B on the diagonal
  Eigen::MatrixXd c;    ///< N x nN: C on the diagonal
};

/// Throws std::invalid_argument unless followers >= 1 and h > 0.
StringMatrices string_matrices(const StateSpace& vehicle, double headway, std::size_t followers);

}  // namespace platoon
