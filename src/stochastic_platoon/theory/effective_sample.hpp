#pragma once

#include <cstddef>
#include <vector>

#include "stochastic_platoon/model/platoon_model.hpp"

namespace platoon {

/// What one step of an average over time is worth, in independent errors: successive ones are correlated. Of a
/// stationary normal error of spectrum Phi and variance P = < Phi >, < > the mean over the circle, n successive
/// steps have
///     a mean of variance Phi(0) / n:              n P / Phi(0) independent errors,
///     a variance of variance 2 < Phi^2 > / n:     n P^2 / < Phi^2 >,
/// to leading order in 1/n (M. B. Priestley, Spectral Analysis and Time Series, 1981, section 5.3).
struct EffectiveSample {
  double mean = 1.0;
  double variance = 1.0;
};

/// That of each follower's tracking error, with Phi_zeta_i as in linked_string.hpp. NaN from the first follower
/// on behind whose link errors are not normal, as it loses packets, throughout when rho(A) >= 1, and where the spectrum leaves the range of double; 1 where the
/// variance is 0. Dithered quantisation, which is not normal either, counts as normal: its own fourth cumulant
/// is negative, so that a standard error is too large rather than too small. 1e-12 relative. Throws
/// std::invalid_argument unless followers >= 1.
std::vector<EffectiveSample> effective_samples(const PlatoonModel& model, std::size_t followers);

}  // namespace platoon
