#pragma once

#include <vector>

#include "stochastic_platoon/math/model/leader_profile.hpp"
#include "stochastic_platoon/run/configuration/section.hpp"

namespace platoon {

/// The input of vehicle 0: the speeds of the virtual leader, or recorded positions of vehicle 0.
struct LeaderContent {
  LeaderProfile profile{{}, 1.0};
  std::vector<double> recorded;  ///< y_0(-1), y_0(0), ... [m]
};

/// Reads the key `leader`: {speed: [...]}, {positions: [...]}, or {file: ...} with the keys of RecordedDrive. Reports
/// all problems. `steady`: whether the platoon starts in steady motion, which a table has from its first row on.
LeaderContent read_leader(Section section, double sample_period, bool steady);

}  // namespace platoon
