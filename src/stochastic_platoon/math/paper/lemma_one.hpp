#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <cstdint>

#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/math/paper/string_matrices.hpp"
#include "stochastic_platoon/math/string/error_moments.hpp"

// Lemma 1 (lem:mean_square_all) as in the paper, with dense matrices: the reference for error_moments and
// stationary_variances. Time O(steps (nN)^3), or O((nN)^6) for the vec formula.

namespace platoon {

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

/// Eqs. (means_all) and (variance_all) for k = 0 .. steps-1. Throws as error_moments does.
SignalMoments error_moments_by_lemma_one(const PlatoonModel& model, std::size_t followers, std::int64_t steps);

/// The covariance of the noise in the states, shape nN x nN, with P = noise_variance I:
/// \f[ \Upsilon = B_a P B_a' + B_b P B_b' + A B_a P B_b' + B_b P B_a' A'. \f]
Eigen::MatrixXd noise_covariance(const StringMatrices& string, double noise_variance);

/// Stationary covariance of zeta, N x N [m^2], with Upsilon by noise_covariance():
/// \f[ vec^{-1}((C \otimes C) (I - A \otimes A)^{-1} vec(\Upsilon)). \f]
/// Throws std::invalid_argument if rho(A) >= 1.
Eigen::MatrixXd stationary_covariance_by_vec(const StringMatrices& string, double noise_variance);

/// The same from the Lyapunov equation P = A P A' + Upsilon, summed by doubling (P <- P + A P A', A <- A^2). Throws
/// std::invalid_argument if rho(A) >= 1.
Eigen::MatrixXd stationary_covariance_by_lyapunov(const StringMatrices& string, double noise_variance);

/// P = A P A' + Q for square A with rho(A) < 1, by doubling. Throws std::invalid_argument if rho(A) >= 1 or the shapes
/// differ. Reference: R. A. Smith, Matrix equation XA + BX = C, SIAM J. Appl. Math. 16 (1968).
Eigen::MatrixXd solve_discrete_lyapunov(const Eigen::MatrixXd& a, const Eigen::MatrixXd& q);

}  // namespace platoon
