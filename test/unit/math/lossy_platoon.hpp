#pragma once

#include "unit/paper_platoon.hpp"

namespace platoon {

/// The paper's example with losses on every channel.
inline PlatoonModel lossy_platoon(const LossModel& loss, double headway = 3.2) {
  PlatoonModel model = paper_platoon(headway);
  model.default_vehicle().link.loss = loss;
  return model;
}

}  // namespace platoon
