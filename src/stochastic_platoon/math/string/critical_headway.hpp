#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/math/model/closed_loop.hpp"
#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/math/numerics/stable_intervals.hpp"

namespace platoon {

/// The closed loop that a plant and a controller form at headway h, whatever the controller does with h.
using HeadwayLaw = std::function<ClosedLoop(double headway)>;

/// Headways h, in sample periods, searched for string stability.
struct HeadwayRange {
  double from = 0.01;
  double to = 1000.0;
  int samples = 128;                ///< on a logarithmic scale
  std::optional<double> also = {};  ///< a headway to sample beside these
};

/// The range above, widened to a hundredth and a hundred times this headway, with as many samples a decade
/// and one at the headway itself: what is said of it there is what string_stability says.
HeadwayRange headways_about(double headway);

using HeadwayInterval = StableInterval;

/// Which headways make the platoon string stable, within a range.
struct StableHeadways {
  std::vector<HeadwayInterval> intervals;  ///< in ascending order; ends to 1e-12 relative
  std::optional<double> critical;          ///< from here to the end of the range every h is stable; else empty
  HeadwayRange searched;
  std::vector<std::string> types = {};  ///< of vehicle whose headway is varied, of a platoon
};

/// Samples string_margin over the range, follows it to its extremes where it turns near zero without changing
/// sign, and bisects every change of sign. A stable or unstable stretch is missed only if the margin turns
/// more than once between two samples.
///
/// A headway for which the law or string_margin throw std::invalid_argument counts as unstable. Throws
/// std::invalid_argument unless 0 < from < to and samples >= 2.
StableHeadways stable_headways(const HeadwayLaw& law, const HeadwayRange& range = {});

/// The same by any margin over headways.
StableHeadways stable_headways(const StabilityMargin& margin, const HeadwayRange& range);

/// Of the default vehicle and of the types that inherit its headway, about the model's own. None where the closed loop
/// of one of these was given, which has no other headway, and where no vehicle of the string is one. Throws
/// std::invalid_argument for losses in bursts.
std::optional<StableHeadways> stable_headways(const PlatoonModel& model);

/// Positive just when string_stability finds the platoon string stable, zero at the border, and continuous in
/// the coefficients of T but for their rounding: the smaller of 1 - rho(A) and the minimum of -ln |T|^2 over
/// w in [0, pi], divided by 1 - cos w up to w = pi/2; 1 - rho(A) where that is not positive. Throws as string_stability
/// does.
double string_margin(const ClosedLoop& loop, double headway);

}  // namespace platoon
