#include "stochastic_platoon/ros/observation/run_parameters.hpp"

#include <cstdint>
#include <limits>
#include <string>

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

}  // namespace

void set_run_parameters(const ros::NodeHandle& platoon, const Configuration& configuration) {
  const VehicleModel& vehicle = configuration.model.default_vehicle();
  platoon.setParam("headway", vehicle.headway);
  platoon.setParam("headway_seconds", vehicle.headway * configuration.model.sample_period);
  platoon.setParam("noise_variance", vehicle.position().noise_variance);
  const nlohmann::json run = to_json(configuration.run);
  // An absent option becomes an empty text: the parameter of an earlier run must not remain.
  for (const Setting& setting : settings()) {
    if (setting.model_key == nullptr)
      platoon.setParam(setting.name, parameter(run.value(setting.name, nlohmann::json(""))));
  }
}

}  // namespace platoon
