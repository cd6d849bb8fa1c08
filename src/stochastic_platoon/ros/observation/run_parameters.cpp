#include "stochastic_platoon/ros/observation/run_parameters.hpp"

#include <ros/master.h>
#include <ros/this_node.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/run/configuration/settings.hpp"

namespace platoon {

namespace {

XmlRpc::XmlRpcValue parameter(const nlohmann::json& value) {
  if (value.is_boolean()) return value.get<bool>();
  if (value.is_number_float()) return value.get<double>();
  if (value.is_string()) return value.get<std::string>();
  const bool fits = value.get<double>() <= std::numeric_limits<std::int32_t>::max();
  return fits ? XmlRpc::XmlRpcValue(value.get<int>()) : XmlRpc::XmlRpcValue(value.dump());
}

// Not NodeHandle::setParam(): roscpp 1.15 waits for itself there if the node is stopped meanwhile, as it logs the error
// while it holds the lock that its log needs.
void set_parameter(const ros::NodeHandle& platoon, const std::string& name, const XmlRpc::XmlRpcValue& value) {
  XmlRpc::XmlRpcValue request, response, payload;
  request[0] = ros::this_node::getName();
  request[1] = platoon.resolveName(name);
  request[2] = value;
  ros::master::execute("setParam", request, response, payload, true);
}

// The value that all vehicles of the string share; else an empty text.
template <typename Value>
nlohmann::json shared_value(const std::vector<VehicleModel>& vehicles, const Value& value) {
  const nlohmann::json first = value(vehicles.front());
  const bool is_shared =
      std::all_of(vehicles.begin(), vehicles.end(), [&](const VehicleModel& of) { return value(of) == first; });
  return is_shared ? first : nlohmann::json("");
}

// Losses that one probability describes, with a mean burst or without; null if it does not.
const LossModel* plain_losses(const VehicleModel& vehicle) {
  const std::optional<LossModel>& loss = vehicle.varied_link().loss;
  return loss && !loss->trace && !loss->by_distance && !loss->markov ? &*loss : nullptr;
}

// The values of the settings that override keys of the model.
std::map<std::string, nlohmann::json> model_values(const PlatoonModel& model) {
  using json = nlohmann::json;
  const std::vector<VehicleModel> vehicles = pattern(model);
  const auto headway = [&vehicles](double unit) {
    return shared_value(
        vehicles, [unit](const VehicleModel& of) { return of.constant_spacing ? json("") : json(of.headway * unit); });
  };
  return {{"headway", headway(1.0)},
          {"headway_seconds", headway(model.sample_period)},
          {"noise_variance",
           shared_value(vehicles, [](const VehicleModel& of) { return json(of.position().noise_variance); })},
          {"loss", shared_value(vehicles,
                                [](const VehicleModel& of) {
                                  const LossModel* loss = plain_losses(of);
                                  if (loss != nullptr) return json(loss->probability);
                                  return of.varied_link().loss ? json("") : json(0.0);
                                })},
          {"mean_burst", shared_value(vehicles,
                                      [](const VehicleModel& of) {
                                        const LossModel* loss = plain_losses(of);
                                        return loss != nullptr && loss->mean_burst ? json(*loss->mean_burst) : json("");
                                      })},
          {"delay", shared_value(vehicles, [](const VehicleModel& of) { return json(of.position().link.delay); })}};
}

}  // namespace

void set_run_parameters(const ros::NodeHandle& platoon, const Configuration& configuration) {
  for (const auto& [name, value] : model_values(configuration.model)) set_parameter(platoon, name, parameter(value));
  const nlohmann::json run = to_json(configuration.run);
  // An absent option becomes an empty text: the parameter of an earlier run must not remain.
  for (const Setting& setting : settings()) {
    if (setting.model_key == nullptr)
      set_parameter(platoon, setting.name, parameter(run.value(setting.name, nlohmann::json(""))));
  }
}

}  // namespace platoon
