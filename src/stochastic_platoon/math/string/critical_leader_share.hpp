#pragma once

#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/math/numerics/stable_intervals.hpp"

namespace platoon {

/// Weights of the leader's position that make the platoon string stable, for all vehicles that hear it.
struct StableLeaderShares {
  std::vector<StableInterval> intervals;  ///< within [0, 1], in ascending order
  std::optional<double> critical;         ///< every share from here to 1 is stable; none if there is no such share
  std::vector<std::string> types;         ///< types with varied weights
};

/// The platoon with this weight of the leader's position in every vehicle that hears it. The weights of its other
/// positions keep their ratios and sum to 1 with it.
PlatoonModel with_leader_share(PlatoonModel model, double share);

/// Samples the share at multiples of 0.05 and at the present values; see stable_intervals(). None if no vehicle of the
/// string hears the positions of the leader and of another vehicle. Throws as string_stability() does.
std::optional<StableLeaderShares> stable_leader_shares(const PlatoonModel& model);

}  // namespace platoon
