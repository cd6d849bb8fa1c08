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

}  // namespace platoon
