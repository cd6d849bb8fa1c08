#pragma once

#include <cstddef>
#include <vector>

#include "stochastic_platoon/math/string/burst_pattern.hpp"
#include "stochastic_platoon/math/string/string_stability.hpp"

namespace platoon {

/// Stationary theory of a platoon whose positions are lost in bursts, homogeneous or patterned; links with independent
/// losses or without losses may be among them. With < > the mean over the circle, Phi_i the spectrum of y_i about its
/// mean, Phi_0 = 0, N_d the spectrum of the noise of link i, v metres per step, and T_L, u, g as in BurstLink,
/// \f[ \Phi_i = |\hat T|^2 \Phi_{i-1} + |T|^2 (|T_L|^2 N_d + G_i), \qquad \hat T = T_L z^{-m} T, \f]
/// \f[ P_i = \langle |1 - H \hat T|^2 \Phi_{i-1} + |H|^2 |T|^2 (|T_L|^2 N_d + G_i) \rangle, \f]
/// \f[ G_i = \langle g(w, \nu) |u|^2 (\Phi_{i-1} + N_d) \rangle + v^2 (c_1 + 2 c_2 + \ldots)^2 g(w, 0). \f]
///
/// All functions throw std::invalid_argument for a string with radios and for losses that strictly alternate with
/// arrivals: see no_burst_theory().

/// Stationary variances P_1, ..., P_N [m^2]; infinity if they leave the range of double. NaN throughout if a vehicle or
/// a link is not mean square stable. Throws std::invalid_argument unless followers >= 1.
std::vector<double> burst_stationary_variances(const PlatoonModel& model, std::size_t followers);

/// Stationary means of the errors at the leader's last speed [m]: v times the mean lag. NaN as above.
std::vector<double> burst_stationary_means(const PlatoonModel& model, std::size_t followers);

/// Stability of the platoon. It is mean square stable exactly if every rho(A) < 1 and every second_moment_radius() < 1.
/// It is string stable exactly if, in addition, |prod T^| < 1 over one pattern for all w > 0 and the loss gain is
/// below 1: the spectral radius of the operator from the drives f_l = |u_l|^2 Phi of the losses at every place l of the
/// pattern to those that they cause at every place, over all repetitions,
///
///     f_j' = |u_j|^2 sum_l (product of |T^|^2 between l and j) |T_l|^2 < g_l(w, nu) f_l > / (1 - prod |T^|^2).
///
/// For independent losses it is the loss gain of linked_string_stability(). `limit_variance` is the largest of the
/// pattern's limits.
StringStability burst_string_stability(const PlatoonModel& model);

/// Positive exactly if all conditions of burst_string_stability() hold, apart from that on the loss gain.
double burst_gain_margin(const BurstPattern& pattern);

/// 1 / loss gain - 1 for a positive burst_gain_margin(): positive exactly if the loss gain is below 1; infinite without
/// losses.
double burst_loss_margin(const BurstPattern& pattern);

}  // namespace platoon
