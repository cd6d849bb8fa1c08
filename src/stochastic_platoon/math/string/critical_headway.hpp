#pragma once

#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/math/numerics/stable_intervals.hpp"

namespace platoon {

/// Headways h, in sample periods, searched for string stability.
struct HeadwayRange {
  double from = 0.01;
  double to = 1000.0;
  int samples = 128;                ///< on a logarithmic scale
  std::optional<double> also = {};  ///< a further headway to sample
};

/// The range above, extended to a hundredth and to a hundred times this headway, with as many samples per decade and
/// one at the headway itself, so that the result there agrees with string_stability.
HeadwayRange headways_about(double headway);

using HeadwayInterval = StableInterval;

/// Headways within a range that make the platoon string stable.
struct StableHeadways {
  std::vector<HeadwayInterval> intervals;  ///< in ascending order
  std::optional<double> critical;          ///< every h from here to the end of the range is stable; empty if none
  HeadwayRange searched;
  std::vector<std::string> types = {};  ///< vehicle types of the platoon with varied headway
};

/// Stable headways by a margin as a function of the headway, positive where the platoon is string stable; `necessary`
/// as in stable_intervals(), which samples the range, follows the margin to its extremes if it turns near zero without
/// changing sign, and bisects every change of sign. A stable or unstable stretch is missed only if the margin turns
/// more than once between two samples. Throws std::invalid_argument unless 0 < from < to and samples >= 2.
StableHeadways stable_headways(const StabilityMargin& margin, const HeadwayRange& range = {},
                               const StabilityMargin& necessary = {}, double accuracy = 1e-12);

/// Stable headways of the default vehicle and of the types that inherit its headway, in the range about the model's
/// own. None if one of these has a given closed loop, which fits one headway only, or if the string contains none of
/// them, and with constant spacing. Throws std::invalid_argument for a model without theory: see no_theory().
std::optional<StableHeadways> stable_headways(const PlatoonModel& model);

}  // namespace platoon
