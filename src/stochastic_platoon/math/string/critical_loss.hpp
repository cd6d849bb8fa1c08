#pragma once

#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/math/numerics/stable_intervals.hpp"

namespace platoon {

/// Loss probabilities that make the platoon string stable, for the links into the default vehicle and into the types
/// that inherit it.
struct StableLosses {
  std::vector<StableInterval> intervals;  ///< within [0, 0.99], in ascending order
  /// The platoon is string stable for every smaller probability; none if it is unstable without losses or always
  /// stable.
  std::optional<double> critical;
  std::vector<std::string> types;  ///< types with varied links
};

/// Links without a loss stage hold the last received position. None if no vehicle of the string uses the default link.
/// The probability is sampled at multiples of 0.01, or of 0.05 without a loss stage; see stable_intervals(). Throws as
/// linked_string_stability() does.
std::optional<StableLosses> stable_losses(const PlatoonModel& model);

}  // namespace platoon
