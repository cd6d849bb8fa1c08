#include "stochastic_platoon/math/response/vehicle_response.hpp"
#include "stochastic_platoon/math/model/input.hpp"

#include <cmath>
#include <utility>

namespace platoon {

VehicleResponse::VehicleResponse(const VehicleModel& vehicle) {
  if (vehicle.radio() != nullptr) feed_forward_ = vehicle.radio()->gain;
  if (vehicle.design && vehicle.design->sends_input) {
    parts_ = loop_parts<long double>(*vehicle.design, vehicle.headway);
  } else {
    loop_.emplace(vehicle.loop);
  }
}

VehicleResponse::VehicleResponse(const VehicleModel& vehicle, std::size_t follower, double sample_period) {
  if (vehicle.hears_predecessor_only()) {
    *this = VehicleResponse(vehicle);
    return;
  }
  parts_ = loop_parts<long double>(*vehicle.design, vehicle.headway);
  parts_->spacing *= static_cast<long double>(spacing_in_vehicles(vehicle, follower));
  feed_forward_ = 1.0L;
  own_speed_ = own_speed_gain(vehicle, sample_period);
  own_acceleration_ = vehicle.own_acceleration / (static_cast<long double>(sample_period) * sample_period);
}

Motion VehicleResponse::operator()(const Motion& received) const {
  if (loop_) return {(*loop_)(received.position), {}};
  return by_parts(Sequence(parts_->order(), 0.0L), received);
}

Motion VehicleResponse::free_motion(std::size_t count) const {
  if (loop_) return {loop_->free_response(count), {}};
  return by_parts(unit_equilibrium(*parts_), {Sequence(count, 0.0L), {}});
}

Motion VehicleResponse::by_parts(Sequence state, const Motion& received) const {
  Motion own;
  own.position.reserve(received.position.size());
  own.input.reserve(received.position.size());
  long double input = 0.0L;
  for (std::size_t k = 0; k < received.position.size(); ++k) {
    own.position.push_back(state.front());
    own.input.push_back(input);
    long double forward = received.input.empty() ? 0.0L : feed_forward_ * received.input[k];
    if (own_speed_ != 0.0L || own_acceleration_ != 0.0L) {
      const long double now = own.position[k], before = own.position[k > 0 ? k - 1 : 0],
                        earlier = own.position[k > 1 ? k - 2 : 0];
      forward += own_acceleration_ * (now - 2.0L * before + earlier) - own_speed_ * (now - before);
    }
    input = advance(*parts_, state, received.position[k], forward);
    for (long double& value : state) {
      if (std::abs(value) < LoopResponse::kNegligibleState) value = 0.0L;
    }
  }
  return own;
}

}  // namespace platoon
