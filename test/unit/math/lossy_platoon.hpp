#pragma once

#include <memory>
#include <vector>

#include "stochastic_platoon/math/model/input.hpp"
#include "unit/paper_platoon.hpp"

namespace platoon {

/// The paper's example with losses on every channel.
inline PlatoonModel lossy_platoon(const LossModel& loss, double headway = 3.2) {
  PlatoonModel model = paper_platoon(headway);
  model.default_vehicle().position().link.loss = loss;
  return model;
}

/// Losses by the states of a chain.
inline LossModel by_states(const Eigen::MatrixXd& transition, const Eigen::VectorXd& probability,
                           const std::vector<double>& predictor) {
  LossModel loss{0.0, {}, predictor};
  loss.markov = std::make_shared<MarkovLosses>(transition, probability);
  loss.probability = loss.markov->loss_probability();
  return loss;
}

}  // namespace platoon
