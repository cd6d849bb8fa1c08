#pragma once

#include <Eigen/Dense>
#include <array>
#include <cstddef>
#include <vector>

#include "stochastic_platoon/math/string/linked_vehicle.hpp"
#include "stochastic_platoon/math/string/string_stability.hpp"

namespace platoon {

/// Stationary theory of a platoon over links with independent losses, homogeneous or patterned. With < > the mean over
/// the circle, Phi_i the spectrum of y_i about its mean, Phi_0 = 0, and the notation of LinkedVehicleValue, with sums
/// over the links l of follower i and Psi_l the spectrum of the values sent over link l, Phi_{i-1} for the position and
/// Phi_{i-1} / |G_{i-1}|^2 for the predecessor's input:
/// \f[ \sigma_l^2 = \kappa (\langle |(1-L) F|^2 (\Psi_l + N_d) \rangle + \bar e^2), \f]
/// \f[ \Phi_i = |\hat T|^2 \Phi_{i-1} + \sum_l (p^2 |N F|^2 N_d + |N F|^2 \sigma_l^2), \f]
/// \f[ P_i = \langle |1 - H \hat T|^2 \Phi_{i-1} + |H|^2 \sum_l (p^2 |N F|^2 N_d + |N F|^2 \sigma_l^2) \rangle, \f]
/// each with the T, h and links of follower i; ebar = v (c_1 + 2 c_2 + ...) / p at v metres per step for the position.

/// Stationary variances P_1, ..., P_N [m^2]; infinity if they leave the range of double. NaN throughout if a vehicle or
/// a link is not mean square stable. 1e-12 relative. Throws std::invalid_argument unless followers >= 1, and for losses
/// in bursts.
std::vector<double> linked_stationary_variances(const PlatoonModel& model, std::size_t followers);

/// The shares of the links that measure positions and of the radios in these variances [m^2], from noise and losses of
/// all vehicles; per follower the share of the position and that of the predecessor's input. Infinite or NaN where the
/// variance is.
std::vector<std::array<double, 2>> stationary_variances_by_input(const PlatoonModel& model, std::size_t followers);

/// The leader's last speed, in metres per step.
double metres_per_step(const PlatoonModel& model);

/// Stationary means of the errors at the leader's last speed [m]: v (m + q (c_1 + 2 c_2 + ...) / p). NaN as above.
/// For losses in bursts this function returns burst_stationary_means().
std::vector<double> stationary_means(const PlatoonModel& model, std::size_t followers);

/// Stability of the platoon. It is mean square stable exactly if every rho(A) < 1, F is stable and p q ||L F||^2 < 1.
/// It is string stable exactly if, in addition, |prod T^| < 1 over one pattern for all w > 0, decided as in
/// string_stability(), and the spectral radius of the pattern's matrix of loss gains is below 1. Entry (j, l) of this
/// matrix is the contribution of the variance of w_l, over all repetitions, to that of w_j:
///
///     kappa_j < |(1-L_j) F_j|^2 (product of |T^|^2 between l and j) |T_l F_l|^2 / (1 - prod |T^|^2) >.
///
/// `limit_variance` is the largest of the pattern's limits.
StringStability linked_string_stability(const PlatoonModel& model);

/// Positive exactly if all conditions of linked_string_stability() hold, apart from that on the loss gain; needs no
/// spectra. A positive margin is the least attenuation alone, which is smooth in the headway and in the losses.
double linked_gain_margin(const LinkedPattern& pattern);

/// 1 / loss gain - 1 for a positive linked_gain_margin(): positive exactly if the loss gain is below 1; infinite
/// without losses.
double linked_loss_margin(const LinkedPattern& pattern);

}  // namespace platoon
