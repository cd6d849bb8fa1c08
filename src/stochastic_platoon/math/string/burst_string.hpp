#pragma once

#include <cstddef>
#include <vector>

#include "stochastic_platoon/math/string/burst_vehicle.hpp"

namespace platoon {

/// Stationary theory of a platoon whose positions are lost in bursts, homogeneous or patterned; links with independent
/// losses or without losses may be among them. `speed` v in metres per step. With < > the mean over the circle, Phi_i
/// the spectrum of y_i about its mean, Phi_0 = 0, N_d the spectrum of the noise of link i, and T_L, u, g as in
/// BurstLink,
/// \f[ \Phi_i = |\hat T|^2 \Phi_{i-1} + |T|^2 (|T_L|^2 N_d + G_i), \qquad \hat T = T_L z^{-m} T, \f]
/// \f[ P_i = \langle |1 - H \hat T|^2 \Phi_{i-1} + |H|^2 |T|^2 (|T_L|^2 N_d + G_i) \rangle, \f]
/// \f[ G_i = \langle g(w, \nu) |u|^2 (\Phi_{i-1} + N_d) \rangle + v^2 (c_1 + 2 c_2 + \ldots)^2 g(w, 0). \f]
///
/// The functions require a mean square stable pattern; those of an endless string, a positive gain_margin(), too.

/// P_1, ..., P_N [m^2]; infinity where it leaves the range of double.
std::vector<double> stationary_variances(const BurstPattern& pattern, double speed, std::size_t followers);

/// The limit of the variance [m^2] at each place of the pattern of an endless string.
std::vector<double> limit_variances(const BurstPattern& pattern, double speed);

/// The loss gain of an endless string: the spectral radius of the operator from the drives f_l = |u_l|^2 Phi of the
/// losses at every place l of the pattern to those that they cause at every place, over all repetitions; 0 without
/// losses, and that of linked_string.hpp for independent ones. 1e-12 relative.
///
///     f_j' = |u_j|^2 sum_l (product of |T^|^2 between l and j) |T_l|^2 < g_l(w, nu) f_l > / (1 - prod |T^|^2)
double loss_gain(const BurstPattern& pattern);

/// 1 / loss gain - 1, with the exact sign at less cost; infinite without losses.
double loss_margin(const BurstPattern& pattern);

}  // namespace platoon
