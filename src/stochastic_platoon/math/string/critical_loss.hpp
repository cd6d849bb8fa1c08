#pragma once

#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/math/numerics/stable_intervals.hpp"

namespace platoon {

/// Which loss probabilities of the links into the default vehicle, and into the types that inherit it, make the
/// platoon string stable.
struct StableLosses {
  std::vector<StableInterval> intervals;  ///< within [0, 0.99], in ascending order
  /// The platoon is string stable for every probability below it; none where it is unstable without losses, or
  /// stable throughout.
  std::optional<double> critical;
  std::vector<std::string> types;  ///< whose links are varied
};

/// Links without a loss stage hold the last received position. None where no vehicle of the string follows the default
/// link. Sampled at multiples of 0.01, without a loss stage of 0.05; see stable_intervals(). Throws as
/// linked_string_stability() does.
std::optional<StableLosses> stable_losses(const PlatoonModel& model);

}  // namespace platoon
