#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <vector>

#include "stochastic_platoon/math/string/linked_vehicle.hpp"
#include "stochastic_platoon/math/string/string_stability.hpp"

namespace platoon {

/// Stationary theory of a platoon over links with independent losses, homogeneous or patterned. With < > the mean over
/// the circle, Phi_i the spectrum of y_i about its mean, Phi_0 = 0, and the notation of LinkedVehicleValue:
///     sigma_i^2 = kappa ( <|(1-L) F|^2 (Phi_{i-1} + N_d)> + ebar^2 )
///     Phi_i = |T^|^2 (Phi_{i-1} + N_d) + |T F|^2 sigma_i^2
///     P_i = < |1 - H T^|^2 Phi_{i-1} + |H|^2 (|T^|^2 N_d + |T F|^2 sigma_i^2) >
/// each with the T, h and link of follower i; ebar = v (c_1 + 2 c_2 + ...) / p at v metres per step.

/// Stationary variances P_1, ..., P_N [m^2]; infinity if they leave the range of double. NaN throughout if a vehicle or
/// a link is not mean square stable. 1e-12 relative. Throws std::invalid_argument unless followers >= 1, and for losses
/// in bursts.
std::vector<double> linked_stationary_variances(const PlatoonModel& model, std::size_t followers);

/// Stationary means of the errors at the leader's last speed [m]: v (m + q (c_1 + 2 c_2 + ...) / p). NaN as above.
std::vector<double> stationary_means(const PlatoonModel& model, std::size_t followers);

/// Stability of the platoon. It is mean square stable exactly if every rho(A) < 1, F is stable and p q ||L F||^2 < 1.
/// It is string stable exactly if, in addition, |prod T^| < 1 over one pattern for all w > 0, decided as in
/// string_stability(), and the spectral radius of the pattern's matrix of loss gains is below 1. Entry (j, l) of this
/// matrix is the contribution of the variance of w_l, over all repetitions, to that of w_j:
///     kappa_j < |(1-L_j) F_j|^2 (product of |T^|^2 between l and j) |T_l F_l|^2 / (1 - prod |T^|^2) >.
/// `limit_variance` is the largest of the pattern's limits.
StringStability linked_string_stability(const PlatoonModel& model);

/// Positive exactly if linked_string_stability() finds the platoon string stable.
double linked_string_margin(const LinkedPattern& pattern);

/// Positive exactly if linked_string_stability() has no objection but the loss gain; needs no spectra.
double linked_gain_margin(const LinkedPattern& pattern);

}  // namespace platoon
