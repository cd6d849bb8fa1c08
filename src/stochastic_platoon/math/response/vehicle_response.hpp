#pragma once

#include <cstddef>
#include <optional>

#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/math/response/loop_response.hpp"

namespace platoon {

/// The motion that a vehicle sends: its positions y(k) and, in a string with radios, v(k) = u(k-1); else no inputs.
/// Sequences start at step -1.
struct Motion {
  LoopResponse::Sequence position, input;
};

/// A vehicle as an operator on finite sequences, in extended precision: T alone, or where control inputs are sent or a
/// vehicle hears others than its predecessor part by part, with its control inputs.
class VehicleResponse {
public:
  using Sequence = LoopResponse::Sequence;

  /// A vehicle that hears its predecessor alone.
  explicit VehicleResponse(const VehicleModel& vehicle);

  /// Follower i of a platoon of this sample period [s].
  VehicleResponse(const VehicleModel& vehicle, std::size_t follower, double sample_period);

  /// From the zero state. `received` has the positions and, for a vehicle with feed-forward, the inputs as received. Of
  /// a vehicle that hears others than its predecessor: the weighted sum of the positions, and that of all other
  /// signals.
  Motion operator()(const Motion& received) const;

  /// The free motion from the equilibrium with y = 1.
  Motion free_motion(std::size_t count) const;

private:
  Motion by_parts(LoopResponse::Sequence state, const Motion& received) const;

  std::optional<LoopResponse> loop_;
  std::optional<BasicLoopParts<long double>> parts_;
  long double feed_forward_ = 0.0L;                         ///< F
  long double own_speed_ = 0.0L, own_acceleration_ = 0.0L;  ///< gains of D y [1/s^2] and D^2 y [1/s^2]
};

}  // namespace platoon
