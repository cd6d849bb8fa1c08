#pragma once

#include <cstddef>
#include <vector>

#include "stochastic_platoon/math/model/platoon_model.hpp"

namespace platoon {

/// Stationary variances P_1, ..., P_N [m^2] of the tracking errors, paper corollary cor:stationary_all and
/// eq. (pzeta):
///     P_1 = ||HT||_2^2 P_d,   P_i = P_{i-1} + ||S T^{i-1}||_2^2 P_d,
/// by quadrature over the unit circle, refined until it no longer changes; 1e-12 relative. For a string
/// unstable platoon they grow without bound, to infinity where they leave the range of double.
///
/// Of any other platoon than the paper's they are linked_stationary_variances().
///
/// NaN throughout when rho(A) >= 1: there is no stationary variance. Throws std::invalid_argument unless
/// followers >= 1, and when S has fewer than two zeros at z = 1.
std::vector<double> stationary_variances(const PlatoonModel& model, std::size_t followers);

}  // namespace platoon
