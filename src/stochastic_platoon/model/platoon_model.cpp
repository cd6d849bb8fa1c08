#include "stochastic_platoon/model/platoon_model.hpp"

#include <algorithm>

namespace platoon {

namespace {

std::size_t type_of(const PlatoonModel& model, std::size_t follower) {
  return follower == 0 || model.string.empty() ? 0 : model.string[(follower - 1) % model.string.size()];
}

VehicleModel of_type(const PlatoonModel& model, std::size_t type) {
  if (type > 0) return model.types.at(type - 1).vehicle;
  return {
      model.loop,   model.headway, model.standstill_distance, model.noise_variance, model.initial_position,
      model.design, model.link};
}

}  // namespace

VehicleModel vehicle(const PlatoonModel& model, std::size_t follower) {
  return of_type(model, type_of(model, follower));
}

std::vector<VehicleModel> pattern(const PlatoonModel& model) {
  if (is_homogeneous(model)) return {of_type(model, 0)};
  std::vector<VehicleModel> vehicles;
  for (const std::size_t type : model.string) vehicles.push_back(of_type(model, type));
  return vehicles;
}

bool is_homogeneous(const PlatoonModel& model) {
  return std::all_of(model.string.begin(), model.string.end(), [](std::size_t type) { return type == 0; });
}

bool is_papers(const PlatoonModel& model) {
  return is_homogeneous(model) && model.link.is_white_noise_only();
}

bool has_normal_errors(const PlatoonModel& model) {
  const std::vector<VehicleModel> vehicles = pattern(model);
  return std::all_of(vehicles.begin(), vehicles.end(), [](const VehicleModel& vehicle) {
    const bool loses = vehicle.link.loss && vehicle.link.loss->probability > 0.0;
    return !loses && vehicle.link.quantisation_step == 0.0;
  });
}

double place_in_formation(const PlatoonModel& model, std::size_t follower) {
  if (is_homogeneous(model)) return -static_cast<double>(follower) * model.standstill_distance;
  const auto distance_up_to = [&model](std::size_t last) {
    double distance = 0.0;
    for (std::size_t i = 1; i <= last; ++i) {
      const std::size_t type = type_of(model, i);
      distance +=
          type == 0 ? model.standstill_distance : model.types.at(type - 1).vehicle.standstill_distance;
    }
    return distance;
  };
  const std::size_t length = model.string.size();
  const std::size_t patterns = follower / length;
  return -(static_cast<double>(patterns) * distance_up_to(length) + distance_up_to(follower % length));
}

}  // namespace platoon
