#pragma once

#include <cstddef>
#include <vector>

#include "stochastic_platoon/math/model/platoon_model.hpp"

namespace platoon {

/// Power spectral densities phi_1(w), ..., phi_N(w) [m^2] of the stationary tracking errors at one frequency
/// w [rad/sample], by the recursion of Theorem 1, eq. (zdom_psdz_all):
///     phi_1 = |HT|^2 P_d,   phi_i = |T|^2 phi_{i-1} + |T|^2 |S|^2 P_d + (1 - |T|^2) |1 - S|^2 P_d.
///
/// NaN throughout when rho(A) >= 1. Throws std::invalid_argument unless followers >= 1 and 0 <= w <= pi.
std::vector<double> error_spectra(const PlatoonModel& model, std::size_t followers, double frequency);

/// Norm of F_{zeta_N} = [S T^{N-1} ... S T, -HT] (corollary cor:stationary_all): P_N = norm^2 P_d. NaN when
/// rho(A) >= 1. Throws as stationary_variances does.
double noise_to_error_norm(const PlatoonModel& model, std::size_t followers);

/// The stable and minimum phase M with 1 - T T~ = M M~ of corollary cor:stationary_all. M = F/D with the D of T = N/D,
/// F monic up to a factor and of the degree of D; its zero at z = 1 is exact, the others lie inside the unit circle. M
/// is not unique in sign: M > 0 at infinity.
///
/// Throws std::invalid_argument unless |T| < 1 for all w > 0, the condition for such an M, and rho(A) < 1.
TransferFunction spectral_factor(const PlatoonModel& model);

/// ||W||_2 of a strictly proper or biproper stable W(z), by the Lyapunov equation of its realization. Throws
/// std::invalid_argument when W is improper or has a pole on or outside the unit circle.
double h2_norm(const TransferFunction& transfer);

}  // namespace platoon
