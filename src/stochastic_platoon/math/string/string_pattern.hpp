#pragma once

#include <stdexcept>

#include "stochastic_platoon/math/bursts/burst_string.hpp"
#include "stochastic_platoon/math/links/linked_string.hpp"

namespace platoon {

/// visit(pattern) for the pattern of a platoon: a BurstPattern if its links lose in bursts, else a LinkedPattern. Only
/// this function and varied_margins() choose between the two theories. Throws std::invalid_argument for losses in
/// bursts without theory: see no_burst_theory().
template <class Visit>
auto with_pattern(const PlatoonModel& model, const Visit& visit) {
  if (!has_bursts(model)) return visit(LinkedPattern(model));
  if (const std::optional<std::string> reason = no_burst_theory(model))
    throw std::invalid_argument("mean_burst: no theory, as " + *reason);
  return visit(BurstPattern(model));
}

}  // namespace platoon
