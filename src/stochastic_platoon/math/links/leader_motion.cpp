#include "stochastic_platoon/math/links/leader_motion.hpp"

#include <stdexcept>
#include <string>

#include "stochastic_platoon/math/model/formation.hpp"

namespace platoon {

namespace {

using Sequence = VehicleResponse::Sequence;

// As LeaderVehicle::input().
Sequence accelerations(const Sequence& positions, long double slope, long double period) {
  Sequence inputs{0.0L};
  for (std::size_t k = 1; k < positions.size(); ++k) {
    const long double moved = positions[k] - positions[k - 1];
    inputs.push_back((moved - slope) / (period * period));
    slope = moved;
  }
  return inputs;
}

}  // namespace

Sequence virtual_leader(const PlatoonModel& model, std::size_t steps) {
  Sequence positions{0.0L};
  for (std::int64_t k = -1; positions.size() <= steps; ++k)
    positions.push_back(positions.back() + static_cast<long double>(model.sample_period * model.leader.speed(k)));
  return positions;
}

Motion leader_motion(const PlatoonModel& model, std::size_t steps) {
  Motion received;
  Sequence& positions = received.position;
  if (moves_leader(model)) {
    if (model.recorded_leader.empty()) {
      positions = virtual_leader(model, steps);
    } else if (model.recorded_leader.size() < steps + 1) {
      throw std::invalid_argument("recorded leader: " + std::to_string(model.recorded_leader.size()) +
                                  " positions: must be at least steps + 1 = " + std::to_string(steps + 1));
    } else {
      positions.assign(model.recorded_leader.begin(),
                       model.recorded_leader.begin() + static_cast<std::ptrdiff_t>(steps + 1));
    }
    if (has_radios(model)) received.input = accelerations(positions, start_slope(model), model.sample_period);
    return received;
  }
  positions = virtual_leader(model, steps);
  return VehicleResponse(model.default_vehicle())(received);
}

}  // namespace platoon
