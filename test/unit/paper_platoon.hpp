#pragma once

#include <Eigen/LU>

#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/model/platoon_model.hpp"

namespace platoon {

/// The closed loop of the paper's example (section 6): G = 1 / (z - 1)^2, K = 1.35 / (1 + h) z / (z + 0.89).
inline ClosedLoop paper_loop(double headway) {
  const TransferFunction plant(Eigen::VectorXd::Ones(1), Eigen::Vector3d(1.0, -2.0, 1.0));
  const TransferFunction controller(Eigen::Vector2d(1.35 / (1.0 + headway), 0.0), Eigen::Vector2d(1.0, 0.89));
  return close_loop({plant, controller}, headway);
}

/// Its plant and controller, for any headway.
inline LoopDesign paper_design() {
  return {TransferFunction(Eigen::VectorXd::Ones(1), Eigen::Vector3d(1.0, -2.0, 1.0)),
          TransferFunction(Eigen::Vector2d(1.35, 0.0), Eigen::Vector2d(1.0, 0.89)), true};
}

/// The paper's example: P_d = 0.6 m^2, a virtual leader at 20 m/s from step 0 on, every follower exactly in its place.
inline PlatoonModel paper_platoon(double headway = 3.2) {
  VehicleModel vehicle(paper_loop(headway), headway);
  vehicle.position().noise_variance = 0.6;
  return {vehicle, LeaderProfile({{0, 20.0}}, 0.1)};
}

/// The same loop in other coordinates: no entry of A, B, C is zero or one.
inline StateSpace dense_paper_loop() {
  Eigen::Matrix3d basis;
  basis << 1.0, 0.3, -0.2, 0.5, -1.0, 0.4, 0.1, 0.2, 0.9;
  const StateSpace paper = paper_loop(3.2).realization;
  return {basis * paper.a() * basis.inverse(), basis * paper.b(), paper.c() * basis.inverse()};
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
