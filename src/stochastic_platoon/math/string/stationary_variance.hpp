#pragma once

#include <cstddef>
#include <vector>

#include "stochastic_platoon/math/model/platoon_model.hpp"

namespace platoon {

/// Stationary variances P_1, ..., P_N [m^2] of the tracking errors, paper corollary cor:stationary_all and eq. (pzeta):
/// \f[ P_1 = \|H T\|_2^2 P_d, \qquad P_i = P_{i-1} + \|S T^{i-1}\|_2^2 P_d, \f]
/// by quadrature over the unit circle, refined until it settles; 1e-12 relative. For a string unstable platoon they
/// grow without bound, to infinity if they leave the range of double.
///
/// For a platoon other than the paper's this function returns linked_stationary_variances(), or
/// burst_stationary_variances() for losses in bursts.
///
/// NaN throughout if rho(A) >= 1: there is no stationary variance. Throws std::invalid_argument unless followers >= 1,
/// and if S has fewer than two zeros at z = 1.
std::vector<double> stationary_variances(const PlatoonModel& model, std::size_t followers);

}  // namespace platoon
