#pragma once

#include <cstddef>

#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/math/string/loop_response.hpp"

namespace platoon {

/// A follower and the link into it as operators on means, with losses replaced by their mean effect:
///     r(k) = (L r)(k) + p e(k),   e(k) = s(k) - (L r)(k).
///
/// Position sequences start at step -1; innovation and error sequences start at step 0.
class MeanVehicle {
public:
  using Sequence = LoopResponse::Sequence;

  /// Throws std::invalid_argument for losses in bursts.
  explicit MeanVehicle(const VehicleModel& vehicle);

  struct Passed {
    Sequence innovation;  ///< e(k)
    Sequence position;    ///< y_i
  };

  /// Response to the predecessor's positions, without the own initial position.
  Passed operator()(const Sequence& predecessor) const;

  /// Response to the own link's w: a unit impulse at step 0 on the received position.
  Passed of_loss(std::size_t steps) const;

  /// Free motion from the own equilibrium at position 1.
  Sequence free_motion(std::size_t steps) const { return loop_.free_response(steps + 1); }

  /// zeta_i from the positions of both vehicles.
  Sequence error(const Sequence& predecessor, const Sequence& own) const;

  /// p q: E w(k)^2 = p q E e(k)^2.
  double variance_factor() const { return loss_.probability * (1.0 - loss_.probability); }

private:
  long double probability() const { return loss_.probability; }
  long double prediction(const Sequence& received) const;

  LoopResponse loop_;
  long double headway_;
  std::size_t delay_;
  LossModel loss_;
};

}  // namespace platoon
