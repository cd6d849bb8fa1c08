#pragma once

#include <cstddef>
#include <vector>

#include "stochastic_platoon/math/string/string_stability.hpp"

namespace platoon {

/// Stationary theory of a string whose vehicles hear any vehicles ahead, over links of any losses, by the spectra of
/// HearingSpectra at frequencies that are doubled until the values settle to 1e-9; then they are accurate to 1e-11
/// relative. All functions throw std::invalid_argument for a model without theory: see no_theory().

/// Means of the tracking errors at the leader's last speed [m].
std::vector<double> hearing_means(const PlatoonModel& model, std::size_t followers);

/// The string is stable exactly if every rho(A) < 1, no predictions grow, the product over a pattern of the companion
/// matrices
///
///     [ T_i,i-1  T_i,i-2  ...  T_i,i-r ]
///     [ 1        0        ...  0       ]  ...
///
/// has a spectral radius below 1 for all w > 0, and the variance that losses add does not grow along the string (loss
/// gain below 1). Inputs from the leader add noise alone. `peak_gain` is the largest spectral radius, for one vehicle
/// ahead that of |T|; it is sought on a grid of frequencies, and refined.
StringStability hearing_stability(const PlatoonModel& model);

/// Positive exactly if the string is string stable without what losses add.
double hearing_gain_margin(const PlatoonModel& model);

/// 1 minus the loss gain, for a model whose gain margin is positive; 1 without losses. Its sign is that of the verdict,
/// its value of an accuracy of a few hundredths. Throws NarrowSpectra so near to the border of the gain that 2^15
/// frequencies do not resolve its peak.
double hearing_loss_margin(const PlatoonModel& model);

}  // namespace platoon
