#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/math/model/closed_loop.hpp"
#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/math/numerics/stable_intervals.hpp"

namespace platoon {

/// The closed loop that plant and controller form at headway h; the controller may depend on h.
using HeadwayLaw = std::function<ClosedLoop(double headway)>;

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
  std::vector<HeadwayInterval> intervals;  ///< in ascending order; ends to 1e-12 relative
  std::optional<double> critical;          ///< every h from here to the end of the range is stable; empty if none
  HeadwayRange searched;
  std::vector<std::string> types = {};  ///< vehicle types of the platoon with varied headway
};

/// Samples string_margin over the range, follows it to its extremes if it turns near zero without changing sign, and
/// bisects every change of sign. A stable or unstable stretch is missed only if the margin turns more than once between
/// two samples.
///
/// A headway counts as unstable if the law or string_margin throws std::invalid_argument. Throws std::invalid_argument
/// unless 0 < from < to and samples >= 2.
StableHeadways stable_headways(const HeadwayLaw& law, const HeadwayRange& range = {});

/// The same for any margin as a function of the headway; `necessary` as in stable_intervals().
StableHeadways stable_headways(const StabilityMargin& margin, const HeadwayRange& range,
                               const StabilityMargin& necessary = {});

/// Stable headways of the default vehicle and of the types that inherit its headway, in the range about the model's
/// own. None if one of these has a given closed loop, which fits one headway only, or if the string contains none of
/// them. Throws std::invalid_argument for losses in bursts without theory: see no_burst_theory().
std::optional<StableHeadways> stable_headways(const PlatoonModel& model);

/// Positive exactly if string_stability finds the platoon string stable, zero at the border, and continuous in the
/// coefficients of T up to rounding. The smaller of 1 - rho(A) and the minimum of -ln |T|^2 over w in [0, pi], divided
/// by 1 - cos w up to w = pi/2; 1 - rho(A) alone if it is not positive. Throws as string_stability does.
double string_margin(const ClosedLoop& loop, double headway);

}  // namespace platoon
