#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "stochastic_platoon/math/string/stationary_signals.hpp"

namespace platoon {

/// stationary_signals() of a string whose vehicles hear any vehicles ahead, over links without losses: with
/// the spectra of HearingSpectra, the variance of r (y_{i-1} - y_i) + f D^n y_i (see Signal), or of y_i / G
/// for the control input, is that of its filter on both positions, and `change` has the further filter 1 - 1/z. 1e-9
/// relative.
std::vector<StationarySignal> hearing_signals(const PlatoonModel& model, const std::vector<std::string>& names,
                                              std::size_t followers, bool string_stable);

/// The variances of the tracking errors by the input whose noise and losses cause them, of all vehicles: per follower
/// and input, those of a packet's losses at the first of its inputs. NaN if a loop is not stable.
std::vector<std::vector<double>> hearing_variances_by_input(const PlatoonModel& model, std::size_t followers);

}  // namespace platoon
