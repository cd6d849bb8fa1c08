#include "stochastic_platoon/math/model/platoon_model.hpp"

#include <algorithm>
#include <stdexcept>

#include "stochastic_platoon/math/numerics/text.hpp"

namespace platoon {

namespace {

std::size_t type_of(const PlatoonModel& model, std::size_t follower) {
  return follower == 0 || model.string.empty() ? 0 : model.string[(follower - 1) % model.string.size()];
}

ClosedLoop closed_again(const std::optional<LoopDesign>& design, double headway, const std::string& name) {
  if (!design)
    throw std::invalid_argument("closed_loop of " + name + ": given: must be plant and controller to vary it");
  return close_loop(*design, headway);
}

}  // namespace

VehicleModel vehicle_of_type(const PlatoonModel& model, std::size_t type) {
  if (type > 0) return model.types.at(type - 1).vehicle;
  return {model.loop,   model.headway, model.standstill_distance, model.noise_variance, model.initial_position,
          model.design, model.link};
}

std::vector<std::size_t> type_order(const PlatoonModel& model) {
  return is_homogeneous(model) ? std::vector<std::size_t>{0} : model.string;
}

std::vector<std::string> types_with_default(const PlatoonModel& model, bool Inherited::*inherited) {
  const std::vector<std::size_t> order = type_order(model);
  std::vector<std::string> names;
  for (std::size_t type = 0; type <= model.types.size(); ++type) {
    if (std::find(order.begin(), order.end(), type) == order.end()) continue;
    if (type == 0) names.emplace_back("default");
    if (type > 0 && model.types[type - 1].inherited.*inherited) names.push_back(model.types[type - 1].name);
  }
  return names;
}

PlatoonModel with_headway(PlatoonModel model, double headway) {
  model.headway = headway;
  model.loop = closed_again(model.design, headway, "default");
  for (VehicleType& type : model.types) {
    if (!type.inherited.headway) continue;
    type.vehicle.headway = headway;
    type.vehicle.loop = closed_again(type.vehicle.design, headway, type.name);
  }
  return model;
}

PlatoonModel with_gain(PlatoonModel model, double gain) {
  if (!model.design) throw std::invalid_argument("closed_loop: given: must be plant and controller to vary its gain");
  const TransferFunction& controller = model.design->controller;
  const TransferFunction scaled{controller.numerator() * (gain / controller.numerator()(0)), controller.denominator()};
  model.design->controller = scaled;
  model.loop = close_loop(*model.design, model.headway);
  for (VehicleType& type : model.types) {
    if (!type.inherited.controller || !type.vehicle.design) continue;
    type.vehicle.design->controller = scaled;
    type.vehicle.loop = close_loop(*type.vehicle.design, type.vehicle.headway);
  }
  return model;
}

PlatoonModel with_loss(PlatoonModel model, double probability) {
  if (!model.link.loss) throw std::invalid_argument("channel/loss: absent: must be given to vary its probability");
  const auto vary = [probability](LinkModel& link) {
    link.loss->probability = probability;
    link.loss->mean_burst.reset();
  };
  vary(model.link);
  for (VehicleType& type : model.types) {
    if (type.inherited.loss_probability) vary(type.vehicle.link);
  }
  return model;
}

VehicleModel vehicle(const PlatoonModel& model, std::size_t follower) {
  return vehicle_of_type(model, type_of(model, follower));
}

std::vector<VehicleModel> pattern(const PlatoonModel& model) {
  std::vector<VehicleModel> vehicles;
  for (const std::size_t type : type_order(model)) vehicles.push_back(vehicle_of_type(model, type));
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

std::string duration(std::int64_t steps, const PlatoonModel& model) {
  return formatted("%.6g s", static_cast<double>(steps) * model.sample_period);
}

double place_in_formation(const PlatoonModel& model, std::size_t follower) {
  if (is_homogeneous(model)) return -static_cast<double>(follower) * model.standstill_distance;
  const auto distance_up_to = [&model](std::size_t last) {
    double distance = 0.0;
    for (std::size_t i = 1; i <= last; ++i) {
      const std::size_t type = type_of(model, i);
      distance += type == 0 ? model.standstill_distance : model.types.at(type - 1).vehicle.standstill_distance;
    }
    return distance;
  };
  const std::size_t length = model.string.size();
  const std::size_t patterns = follower / length;
  return -(static_cast<double>(patterns) * distance_up_to(length) + distance_up_to(follower % length));
}

}  // namespace platoon
