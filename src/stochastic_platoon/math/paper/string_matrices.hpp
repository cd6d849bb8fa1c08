#pragma once

#include <Eigen/Dense>
#include <cstddef>

#include "stochastic_platoon/math/model/state_space.hpp"

namespace platoon {

struct PlatoonModel;

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

/// Mean and covariance of xi(0) at the start of the platoon. At step -1 follower i is at p_i = mean + noise in the
/// formation's coordinates, x_i(-1) = x p_i with x the unit equilibrium, x_0(-1) = 0, without noise:
/// \f[ \xi_i(0) = (h x - (1+h) A x) p_i + (A x - (1+h) B) p_{i-1} + B p_{i-2}, \qquad p_0 = p_{-1} = 0. \f]
struct InitialString {
  Eigen::MatrixXd response;    ///< nN x N: xi(0) = response p
  Eigen::VectorXd mean;        ///< nN x 1 [m]
  Eigen::MatrixXd covariance;  ///< nN x nN [m^2], rank at most N
};

/// Throws std::invalid_argument unless followers >= 1, and if the loop has no equilibrium.
InitialString initial_string(const PlatoonModel& model, std::size_t followers);

/// P = A P A' + Q for square A with rho(A) < 1, by doubling. Throws std::invalid_argument if rho(A) >= 1 or the shapes
/// differ. Reference: R. A. Smith, Matrix equation XA + BX = C, SIAM J. Appl. Math. 16 (1968).
Eigen::MatrixXd solve_discrete_lyapunov(const Eigen::MatrixXd& a, const Eigen::MatrixXd& q);

}  // namespace platoon
