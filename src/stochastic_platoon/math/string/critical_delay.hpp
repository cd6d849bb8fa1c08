#pragma once

#include <optional>
#include <string>

#include "stochastic_platoon/math/model/platoon_model.hpp"

namespace platoon {

constexpr double kLongestCriticalDelay = 10000.0;  ///< [steps]

/// Whether vehicles hear anything of their predecessor by radio.
bool hears_by_radio(const PlatoonModel& model);

struct CriticalDelay {
  std::optional<double> steps = {};
  std::string reason = {};  ///< why there is none, after "none, as"
};

/// The largest constant delay of the radio, not necessarily whole, up to which a homogeneous string is string
/// stable from a delay of one step on. The radio carries all that a vehicle hears of its predecessor but positions.
///
/// With A the sum of N_j z^-m_j over the positions of the predecessor and B that of N_j S_j over its other signals (see
/// HearingLoop), \f$ |\hat T|^2 = |A + B z^{-m}|^2 \f$ reaches 1 at the frequency w where
/// \f[ \cos(\arg A - \arg B + w m) = (1 - |A|^2 - |B|^2) / (2 |A B|). \f]
/// The result is the smallest such m >= 1 over all w: the global minimum of a function of w, whose local minima are
/// found on a grid and then to 1e-12. Below 128 steps the verdicts at the whole delays beside the result confirm it.
///
/// None without a radio, in a string of several types, if a vehicle farther ahead than the predecessor is heard (but
/// for the leader), if a link loses packets, if the string is not stable at one step, or if it is stable up to
/// kLongestCriticalDelay.
CriticalDelay critical_delay(const PlatoonModel& model);

}  // namespace platoon
