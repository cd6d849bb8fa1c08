#include "stochastic_platoon/ros/observation/run_parameters.hpp"

#include <ros/master.h>
#include <ros/this_node.h>

#include <cstdint>
#include <limits>
#include <string>

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

}  // namespace

void set_run_parameters(const ros::NodeHandle& platoon, const Configuration& configuration) {
  const VehicleModel& vehicle = configuration.model.default_vehicle();
  set_parameter(platoon, "headway", vehicle.headway);
  set_parameter(platoon, "headway_seconds", vehicle.headway * configuration.model.sample_period);
  set_parameter(platoon, "noise_variance", vehicle.position().noise_variance);
  const nlohmann::json run = to_json(configuration.run);
  // An absent option becomes an empty text: the parameter of an earlier run must not remain.
  for (const Setting& setting : settings()) {
    if (setting.model_key == nullptr)
      set_parameter(platoon, setting.name, parameter(run.value(setting.name, nlohmann::json(""))));
  }
}

}  // namespace platoon
