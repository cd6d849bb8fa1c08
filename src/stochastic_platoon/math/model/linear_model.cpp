#include "stochastic_platoon/math/model/linear_model.hpp"

#include <algorithm>

#include "stochastic_platoon/math/model/exact_transfer.hpp"
#include "stochastic_platoon/math/model/formation.hpp"
#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/model/vehicle.hpp"
#include "stochastic_platoon/math/numerics/special_values.hpp"

namespace platoon {

PlatoonModel without_limits(PlatoonModel model, std::int64_t steps) {
  if (model.recorded_leader.empty() && steps > 0) {
    LeaderVehicle leader(model);
    model.recorded_leader.push_back(leader.start());
    for (std::int64_t k = 0; k < steps; ++k) model.recorded_leader.push_back(leader.step());
  }
  model.start = starts_steady(model) ? Start::steady : Start::rest;
  for (VehicleType& type : model.types) type.vehicle.limits = {};
  return model;
}

PlatoonModel in_moving_frame(PlatoonModel model) {
  const double slope = start_slope(model), speed = slope / model.sample_period;
  if (model.recorded_leader.empty()) {
    std::vector<SpeedChange> changes = model.leader.changes();
    for (SpeedChange& change : changes) change.value -= speed;
    model.leader = LeaderProfile(changes, model.sample_period);
  }
  for (std::size_t k = model.recorded_leader.size(); k-- > 0;)
    model.recorded_leader[k] -= model.recorded_leader.front() + slope * static_cast<double>(k);
  model.start = Start::rest;
  return model;
}

double steady_input(const VehicleModel& own, double slope) {
  const ExactTransfer& plant = own.design->plant.exact();
  if (plant.integrators() >= 2 || slope == 0.0) return 0.0;
  if (plant.integrators() < 1) return kNaN;
  const auto lowest = [](const ExactPolynomial& of) {
    return std::find_if(of.begin(), of.end(), [](const Exact& value) { return value != 0; })->convert_to<double>();
  };
  return slope * lowest(plant.denominator) / lowest(plant.numerator);
}

double steady_value(const PlatoonModel& model, const Signal& signal, std::size_t follower) {
  const VehicleModel& own = vehicle(model, follower);
  if (signal.is_input) return steady_input(own, start_slope(model));
  const double slope = start_slope(model), of_speed = signal.own.order == 1 ? signal.own.factor : 0.0;
  if (own.hears_predecessor_only()) {
    const double lag = own.headway + static_cast<double>(own.position().link.delay);
    return slope * (signal.of_distance() * lag + of_speed);
  }
  const double behind = start_place(model, follower - 1) - start_place(model, follower) - own.standstill_distance;
  return signal.of_distance() * behind + slope * of_speed;
}

}  // namespace platoon
