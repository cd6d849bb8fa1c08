#pragma once

#include <cstddef>
#include <vector>

#include "stochastic_platoon/math/response/pattern_gain.hpp"
#include "stochastic_platoon/math/string/hearing_limit.hpp"

namespace platoon {

/// Stationary theory of a string whose vehicles hear any vehicles ahead, over links of any losses, by the spectra of
/// HearingSpectra at frequencies that are doubled until the values settle to 1e-9; then they are accurate to 1e-11
/// relative. All functions throw std::invalid_argument for a model without theory: see no_theory().

/// Means of the tracking errors at the leader's last speed [m].
std::vector<double> hearing_means(const PlatoonModel& model, std::size_t followers);

/// The largest rho(A), and the largest growth of the second moments of predictions per step.
double hearing_spectral_radius(const PlatoonModel& model);
double hearing_growth(const PlatoonModel& model);

/// What decides whether the gain along a string is below 1 for all w > 0.
struct JudgedGain {
  Sign margin;                 ///< of 1 - gain over all w > 0; zero if the digits of the model do not decide it
  double excess;               ///< of the largest gain over 1
  double frequency;            ///< its frequency [rad/sample]
  bool is_one = false;         ///< at every frequency
  bool grows_at_zero = false;  ///< see LinkedPattern::grows_at_zero()
  bool falls_apart = false;    ///< see HearingGain::falls_apart()
};
JudgedGain hearing_gain(const PlatoonModel& model);

/// The end of an endless string whose gain is below 1. Without variances so near to the border of stability that only
/// the side of 1 of the loss gain is known.
StringEnd hearing_limit(const PlatoonModel& model);

/// Positive exactly if the string is string stable without what losses add.
double hearing_gain_margin(const PlatoonModel& model);

/// 1 minus the loss gain, for a model whose gain margin is positive; 1 without losses. Its sign is that of the verdict,
/// its value of an accuracy of a few hundredths. Throws NarrowSpectra so near to the border of the gain that 2^18
/// frequencies do not resolve its peak.
double hearing_loss_margin(const PlatoonModel& model);

}  // namespace platoon
