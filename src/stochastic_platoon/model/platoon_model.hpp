#pragma once

#include <optional>
#include <vector>

#include "stochastic_platoon/model/closed_loop.hpp"
#include "stochastic_platoon/model/leader_profile.hpp"

namespace platoon {

/// Initial position of follower i: -i delta plus N(mean, variance), independent per follower and realization.
struct InitialPosition {
  double mean = 0.0;      ///< [m]
  double variance = 0.0;  ///< [m^2], >= 0
};

/// Everything the mathematics of a homogeneous platoon needs (paper, section 3); the model file in C++.
///
/// A plain value: what uses a part of it checks that part (ClosedLoopBatch, NoisyChannel, FollowerVehicle,
/// LeaderVehicle throw std::invalid_argument), and the model file's parser checks all of it.
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
  /// y_0(-1), y_0(0), ... [m]: vehicle 0 as it was recorded, in place of the loop behind `leader`. Empty: none.
  std::vector<double> recorded_leader = {};
};

}  // namespace platoon
