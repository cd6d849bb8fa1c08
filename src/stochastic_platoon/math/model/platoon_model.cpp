#include "stochastic_platoon/math/model/platoon_model.hpp"

#include <algorithm>
#include <stdexcept>

#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"

namespace platoon {

namespace {

std::size_t type_of(const PlatoonModel& model, std::size_t follower) {
  return follower == 0 || model.string.empty() ? 0 : model.string[(follower - 1) % model.string.size()];
}

ClosedLoop closed_again(const VehicleType& type, const char* varied, const ClosedLoop* before = nullptr) {
  if (type.vehicle.design) return close_loop(*type.vehicle.design, type.vehicle.headway, before);
  throw std::invalid_argument("closed_loop of " + type.name + ": given: must be plant and controller to vary " +
                              varied);
}

bool any_type(const PlatoonModel& model, const std::function<bool(const VehicleModel&)>& condition) {
  const std::vector<std::size_t> order = type_order(model);
  return std::any_of(order.begin(), order.end(),
                     [&](std::size_t type) { return condition(model.types.at(type).vehicle); });
}

}  // namespace

std::vector<std::size_t> type_order(const PlatoonModel& model) {
  return is_homogeneous(model) ? std::vector<std::size_t>{0} : model.string;
}

std::vector<std::string> types_with_default(const PlatoonModel& model, bool Inherited::*inherited) {
  const std::vector<std::size_t> order = type_order(model);
  std::vector<std::string> names;
  for (std::size_t type = 0; type < model.types.size(); ++type) {
    const bool present = std::find(order.begin(), order.end(), type) != order.end();
    if (present && model.types[type].inherited.*inherited) names.push_back(model.types[type].name);
  }
  return names;
}

PlatoonModel with_headway(PlatoonModel model, double headway) {
  for (VehicleType& type : model.types) {
    if (!type.inherited.headway || type.vehicle.constant_spacing) continue;
    type.vehicle.headway = headway;
    type.vehicle.loop = closed_again(type, "it", &type.vehicle.loop);
  }
  return model;
}

PlatoonModel with_gain(PlatoonModel model, double gain) {
  const std::optional<LoopDesign>& design = model.default_vehicle().design;
  if (!design) closed_again(model.types.front(), "its gain");  // throws
  const Controller scaled = design->controller.with_gain(gain);
  for (VehicleType& type : model.types) {
    if (!type.inherited.controller || !type.vehicle.design) continue;
    type.vehicle.design->controller = scaled;
    type.vehicle.loop = closed_again(type, "its gain");
  }
  return model;
}

PlatoonModel with_loss_stage(PlatoonModel model) {
  if (model.default_vehicle().varied_link().loss) return model;
  const std::vector<std::size_t> varied = model.default_vehicle().varied_inputs();
  for (std::size_t t = 0; t < model.types.size(); ++t) {
    VehicleType& type = model.types[t];
    std::vector<Input>& inputs = type.vehicle.inputs;
    if (t > 0 && (!type.inherited.inputs || inputs[varied.front()].link.loss)) {
      if (!type.vehicle.varied_link().loss) type.inherited.loss_probability = type.inherited.mean_burst = false;
      continue;
    }
    for (const std::size_t n : varied) inputs[n].link.loss = LossModel{};
    type.inherited.loss_probability = type.inherited.mean_burst = true;
  }
  return model;
}

PlatoonModel with_loss(PlatoonModel model, double probability) {
  if (!model.default_vehicle().varied_link().loss)
    throw std::invalid_argument("channel/loss: absent: must be given to vary its probability");
  for (VehicleType& type : model.types) {
    if (!type.inherited.loss_probability) continue;
    type.vehicle.vary([probability](LinkModel& link) {
      link.loss->probability = probability;
      link.loss->trace.reset();
      link.loss->by_distance.reset();
      link.loss->markov.reset();
    });
  }
  return model;
}

PlatoonModel with_mean_burst(PlatoonModel model, double mean_burst) {
  if (!model.default_vehicle().varied_link().loss)
    throw std::invalid_argument("channel/loss: absent: must be given to vary its mean burst");
  for (VehicleType& type : model.types) {
    if (type.inherited.mean_burst)
      type.vehicle.vary([mean_burst](LinkModel& link) { link.loss->mean_burst = mean_burst; });
  }
  return model;
}

bool any_link(const PlatoonModel& model, const std::function<bool(const LinkModel&)>& condition) {
  return any_type(model, [&](const VehicleModel& of) {
    return std::any_of(of.inputs.begin(), of.inputs.end(), [&](const Input& input) { return condition(input.link); });
  });
}

const VehicleModel& vehicle(const PlatoonModel& model, std::size_t follower) {
  return model.types.at(type_of(model, follower)).vehicle;
}

std::vector<VehicleModel> pattern(const PlatoonModel& model) {
  std::vector<VehicleModel> vehicles;
  for (const std::size_t type : type_order(model)) vehicles.push_back(model.types.at(type).vehicle);
  return vehicles;
}

bool is_homogeneous(const PlatoonModel& model) {
  return std::all_of(model.string.begin(), model.string.end(), [](std::size_t type) { return type == 0; });
}

std::vector<std::int64_t> steps_from_leader(const PlatoonModel& model, std::size_t followers) {
  std::vector<std::int64_t> to_position{0}, to_error;  // y_i(k) depends on its sources up to step k - 1
  for (std::size_t i = 1; i <= followers; ++i) {
    std::int64_t nearest = to_position.back();
    for (const Input& input : vehicle(model, i).inputs) nearest = std::min(nearest, to_position[source_of(input, i)]);
    to_error.push_back(std::min(to_position.back(), nearest + 1));
    to_position.push_back(nearest + 1);
  }
  return to_error;
}

bool is_papers(const PlatoonModel& model) {
  return is_homogeneous(model) && hears_predecessors_only(model) && !has_radios(model) && !has_limits(model) &&
         model.default_vehicle().position().link.is_white_noise_only();
}

bool has_radios(const PlatoonModel& model) {
  return any_type(model, [](const VehicleModel& of) {
    return std::any_of(of.inputs.begin(), of.inputs.end(),
                       [](const Input& input) { return input.signal == InputSignal::input; });
  });
}

bool hears_predecessors_only(const PlatoonModel& model) {
  return !any_type(model, [](const VehicleModel& of) { return !of.hears_predecessor_only(); });
}

std::size_t farthest_ahead(const PlatoonModel& model) {
  std::size_t farthest = 1;
  for (const std::size_t type : type_order(model)) {
    for (const Input& input : model.types.at(type).vehicle.inputs) farthest = std::max(farthest, input.ahead);
  }
  return farthest;
}

bool sends_input(const PlatoonModel& model, std::size_t sender, std::size_t followers) {
  const std::size_t farthest = sender == 0 ? followers : std::min(followers, sender + farthest_ahead(model));
  for (std::size_t i = sender + 1; i <= farthest; ++i) {
    for (const Input& input : vehicle(model, i).inputs) {
      if (input.signal == InputSignal::input && source_of(input, i) == sender) return true;
    }
  }
  return false;
}

bool loses(const PlatoonModel& model) {
  return any_link(model, [](const LinkModel& link) { return link.loses(); });
}

bool depends_on_gap(const PlatoonModel& model) {
  return any_link(model, [](const LinkModel& link) { return link.loses() && link.loss->by_distance; });
}

bool has_normal_errors(const PlatoonModel& model) {
  return !has_limits(model) && !any_link(model, [](const LinkModel& link) { return !link.is_normal(); });
}

void require_normal_errors(const PlatoonModel& model) {
  if (has_normal_errors(model)) return;
  throw std::invalid_argument("model: has losses, quantisation or limits: must have normal errors");
}

std::string duration(std::int64_t steps, const PlatoonModel& model) {
  return formatted("%.6g s", static_cast<double>(steps) * model.sample_period);
}

std::string duration_in_steps(std::int64_t steps, const PlatoonModel& model) {
  return duration(steps, model) + formatted(" (%lld steps)", static_cast<long long>(steps));
}

std::string time_of_step(std::int64_t step, const PlatoonModel& model) {
  return duration(step, model) + formatted(" (step %lld)", static_cast<long long>(step));
}

std::string frequency_text(double w, double sample_period) {
  return formatted("%.6g rad/s (%.6g rad/sample)", w / sample_period, w);
}

bool has_limits(const PlatoonModel& model) {
  return std::any_of(model.types.begin(), model.types.end(),
                     [](const VehicleType& type) { return type.vehicle.limits.any(); });
}

bool moves_leader(const PlatoonModel& model) {
  return !model.recorded_leader.empty() || has_limits(model) || !hears_predecessors_only(model);
}

}  // namespace platoon
