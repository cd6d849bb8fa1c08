#pragma once

#include <optional>

#include "stochastic_platoon/model/closed_loop.hpp"
#include "stochastic_platoon/model/leader_profile.hpp"

namespace platoon {

/// Initial position of follower i: -i delta plus N(mean, variance), independent per follower and realization.
struct InitialPosition {
  double mean = 0.0;      ///< [m]
  double variance = 0.0;  ///< [m^2], >= 0
};

/// Everything the mathematics of a homogeneous platoon needs (paper, section 3); the model file in C++.
struct PlatoonModel {
  ClosedLoop loop;
  double headway;                    ///< h > 0, in sample periods
  double standstill_distance = 0.0;  ///< delta >= 0 [m]
  double sample_period = 0.1;        ///< T_s > 0 [s]; pacing and stamps only
  double noise_variance = 0.0;       ///< P_d >= 0 [m^2]
  LeaderProfile leader;
  InitialPosition initial_position;
  bool allow_unstable = false;            ///< rho(A) >= 1 was asked for
  std::optional<LoopDesign> design = {};  ///< none where the closed loop itself was given
};

}  // namespace platoon
