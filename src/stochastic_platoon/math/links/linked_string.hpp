#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "stochastic_platoon/math/links/linked_vehicle.hpp"

namespace platoon {

/// Stationary theory of a platoon over links with independent losses or none, homogeneous or patterned; `speed` in
/// metres per step. With < > the mean over the circle, Phi_i the spectrum of y_i about its mean, Phi_0 = 0, and the
/// notation of LinkedVehicleValue, with sums over the links l of follower i and Psi_l the spectrum of the values sent
/// over link l, Phi_{i-1} for the position and Phi_{i-1} / |G_{i-1}|^2 for the predecessor's input:
/// \f[ \sigma_l^2 = \kappa (\langle |(1-L) F|^2 (\Psi_l + N_d) \rangle + \bar e^2), \f]
/// \f[ \Phi_i = |\hat T|^2 \Phi_{i-1} + \sum_l (p^2 |N F|^2 N_d + |N F|^2 \sigma_l^2), \f]
/// \f[ P_i = \langle |1 - H \hat T|^2 \Phi_{i-1} + |H|^2 \sum_l (p^2 |N F|^2 N_d + |N F|^2 \sigma_l^2) \rangle, \f]
/// each with the T, h and links of follower i; ebar = v (c_1 + 2 c_2 + ...) / p at v metres per step for the position.
///
/// The functions require a mean square stable pattern; those of an endless string, a positive gain_margin(), too.

/// P_1, ..., P_N [m^2]; infinity where it leaves the range of double. 1e-12 relative.
std::vector<double> stationary_variances(const LinkedPattern& pattern, double speed, std::size_t followers);

/// The shares of the position and of the predecessor's input in them [m^2], from noise and losses of all vehicles.
std::vector<std::array<double, 2>> variances_by_input(const LinkedPattern& pattern, double speed,
                                                      std::size_t followers);

/// The limit of the variance [m^2] at each place of the pattern of an endless string.
std::vector<double> limit_variances(const LinkedPattern& pattern, double speed);

/// The loss gain of an endless string: the spectral radius of the matrix whose entry (j, l) is the contribution of the
/// variance of w_l, over all repetitions of the pattern, to that of w_j; 0 without losses.
///
///     kappa_j < |(1-L_j) F_j|^2 (product of |T^|^2 between l and j) |T_l F_l|^2 / (1 - prod |T^|^2) >
double loss_gain(const LinkedPattern& pattern);

/// 1 / loss gain - 1, with the exact sign at less cost; infinite without losses.
double loss_margin(const LinkedPattern& pattern);

}  // namespace platoon
