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

/// A vehicle as an operator on finite sequences, in extended precision: T alone, or in a string with radios part by
/// part, with its control inputs.
class VehicleResponse {
public:
  using Sequence = LoopResponse::Sequence;

  explicit VehicleResponse(const VehicleModel& vehicle);

  /// From the zero state. `received` has the positions and, for a vehicle with feed-forward, the inputs as received.
  Motion operator()(const Motion& received) const;

  /// The free motion from the equilibrium with y = 1.
  Motion free_motion(std::size_t count) const;

private:
  Motion by_parts(LoopResponse::Sequence state, const Motion& received) const;

  std::optional<LoopResponse> loop_;
  std::optional<BasicLoopParts<long double>> parts_;
  long double feed_forward_ = 0.0L;  ///< F
};

}  // namespace platoon
