#pragma once

#include <optional>

#include "stochastic_platoon/math/model/platoon_model.hpp"

namespace platoon {

constexpr double kLongestCriticalDelay = 10000.0;  ///< [steps]

/// The largest constant delay of the radio [steps], not necessarily whole, up to which a homogeneous string is string
/// stable from a delay of one step on.
///
/// With A = G K z^-m_position and V = H (1 + G K), or 1 + G K H without a headway filter,
/// \f$ |\hat T|^2 = |A + F z^{-m}|^2 / |V|^2 \f$ reaches 1 at the frequency w where
/// \f[ \cos(\arg A - \arg F + w m) = (|V|^2 - |A|^2 - F^2) / (2 |F A|). \f]
/// The result is the smallest such m >= 1 over all w: the global minimum of a function of w, whose local minima are
/// found on a grid and then to 1e-12. Below 128 steps the exact verdicts at the whole delays beside the result confirm
/// it.
///
/// None without a radio, in a string of several types, if a link loses packets, if the string is not stable at one
/// step, or if it is stable up to kLongestCriticalDelay.
std::optional<double> critical_delay(const PlatoonModel& model);

}  // namespace platoon
