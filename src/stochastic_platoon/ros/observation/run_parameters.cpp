#include "stochastic_platoon/ros/observation/run_parameters.hpp"

#include <cstdint>
#include <limits>
#include <string>

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
  nlohmann::json parameters = to_json(configuration.run);
  parameters["headway"] = vehicle.headway;
  parameters["headway_seconds"] = vehicle.headway * configuration.model.sample_period;
  parameters["noise_variance"] = vehicle.noise_variance;
  for (const auto& [name, value] : parameters.items()) platoon.setParam(name, parameter(value));
}

}  // namespace platoon
