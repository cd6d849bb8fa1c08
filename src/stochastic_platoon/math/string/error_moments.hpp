#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "stochastic_platoon/math/links/linked_moments.hpp"

namespace platoon {

/// Exact mean and variance of every tracking error, as in Lemma 1 (lem:mean_square_all), from the structure of the
/// string. By eq. (mu_z_recursive_all) and S = 1 - HT, the response of zeta_{j+m} to the noise d_j is
/// \f[ g_0 = -H T, \qquad g_m = S T^m, \; m \ge 1, \f]
/// and to the initial position p_j, with w(k) = C A^{k+1} x the free motion from x(-1) = x p_j, x the unit equilibrium,
/// \f[ a_0 = -H w, \qquad a_m = S T^{m-1} w, \; m \ge 1, \f]
/// sequences that begin at step -1. With P_d the noise variance, mu and V mean and variance of the initial positions,
/// and zeta_0 the leader's error, mean and variance of zeta_i(k) are
/// \f[ E \zeta_i(k) = (T^i \zeta_0)(k) + \mu \sum_{m<i} a_m(k), \f]
/// \f[ P_{\zeta_i}(k) = \sum_{m<i} (P_d \sum_{l \le k} g_m(l)^2 + V a_m(k)^2). \f]
/// The standstill distance cancels.
///
/// These sums, in double, serve the paper's platoon with loops that plant and controller form without slow poles; the
/// published digests contain their bits. linked_error_moments() serves all others, chain_error_moments() losses in
/// bursts. The error is 1e-12 of the largest term for a mean, and 1e-12 relative for a variance. O(followers steps)
/// time, O(steps) memory beyond the result. Holds for unstable loops too, within the range of double.
///
/// `fourth_cumulants`, if given, receives those of linked_error_moments() where links lose and it serves the model.
///
/// Throws std::invalid_argument unless followers >= 1 and steps >= 1, and if the loop has no equilibrium.
SignalMoments error_moments(const PlatoonModel& model, std::size_t followers, std::int64_t steps,
                            std::vector<double>* fourth_cumulants = nullptr);

/// zeta_0(k) [m] for k = 0 .. steps-1, the error of the leader behind the virtual leader: zeta_0 = S r_0
/// (paper, assumption assum:leader). Throws as error_moments does.
std::vector<double> leader_error(const PlatoonModel& model, std::int64_t steps);

}  // namespace platoon
