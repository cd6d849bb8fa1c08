#pragma once

#include "stochastic_platoon/math/model/platoon_model.hpp"

namespace platoon {

/// The paper's example (section 6): G = 1 / (z - 1)^2, K = 1.35 / (1 + h) z / (z + 0.89), P_d = 0.6 m^2, a
/// virtual leader at 20 m/s from step 0 on, every follower exactly in its place.
inline PlatoonModel paper_platoon(double headway = 3.2) {
  const TransferFunction plant(Eigen::VectorXd::Ones(1), Eigen::Vector3d(1.0, -2.0, 1.0));
  const TransferFunction controller(Eigen::Vector2d(1.35 / (1.0 + headway), 0.0), Eigen::Vector2d(1.0, 0.89));
  return {VehicleModel{close_loop({plant, controller}, headway), headway, 0.0, 0.6}, LeaderProfile({{0, 20.0}}, 0.1)};
}

/// The paper's example with all options: standstill distance, random initial positions, changes of speed.
inline PlatoonModel eventful_platoon(double headway) {
  PlatoonModel model = paper_platoon(headway);
  model.default_vehicle().standstill_distance = 7.0;
  model.default_vehicle().initial_position = {0.8, 0.3};
  model.leader = LeaderProfile({{0, 20.0}, {10, 5.0}, {20, 12.0}}, 0.1);
  return model;
}

}  // namespace platoon
