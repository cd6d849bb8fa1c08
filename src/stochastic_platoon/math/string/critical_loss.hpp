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
  std::vector<StableInterval> intervals;  ///< within [0, largest], in ascending order
  /// The platoon is string stable for every smaller probability; none if it is unstable without losses or always
  /// stable.
  std::optional<double> critical;
  std::vector<std::string> types;  ///< types with varied links
  double largest = 0.99;           ///< largest probability searched
};

/// Links without a loss stage hold the last received position. None if no vehicle of the string uses the default link.
/// The probability is sampled at multiples of 0.01, or of 0.05 without a loss stage or where vehicles hear others than
/// their predecessor, and at its present value; see
/// stable_intervals(). Losses in bursts keep their mean burst b, which the chain has for probabilities up to b / (1 +
/// b). Throws as string_stability() does.
std::optional<StableLosses> stable_losses(const PlatoonModel& given);

}  // namespace platoon
