#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "stochastic_platoon/math/string/signal_moments.hpp"

namespace platoon {

/// Exact moments of the tracking errors, first, and of the signals of these names, from the first step on, in a string
/// whose vehicles hear any vehicles ahead over links without losses. See signal_moments() for the sums over the
/// responses to every noise and initial position; means are those of the same string without noise. A source farther
/// back than the farthest vehicle heard has the responses of the same place one pattern before. 1e-11 relative; for a
/// mean relative to the positions times the signal's factor. Throws std::invalid_argument for links that lose.
std::vector<SignalMoments> hearing_moments(const PlatoonModel& model, const std::vector<std::string>& names,
                                           std::size_t followers, std::int64_t steps);

}  // namespace platoon
