#include "stochastic_platoon/graph/configuration_parameter.hpp"

#include <XmlRpcValue.h>

#include <nlohmann/json.hpp>

namespace platoon {

namespace {

// XmlRpcValue's accessors are not const, hence the value argument.
YAML::Node to_yaml(XmlRpc::XmlRpcValue value) {
  YAML::Node node;
  switch (value.getType()) {
    case XmlRpc::XmlRpcValue::TypeBoolean:
      return YAML::Node(static_cast<bool>(value));
    case XmlRpc::XmlRpcValue::TypeInt:
      return YAML::Node(static_cast<int>(value));
    case XmlRpc::XmlRpcValue::TypeDouble:
      return YAML::Node(nlohmann::json(static_cast<double>(value)).dump());
    case XmlRpc::XmlRpcValue::TypeString:
      return YAML::Node(static_cast<std::string>(value));
    case XmlRpc::XmlRpcValue::TypeArray:
      node = YAML::Node(YAML::NodeType::Sequence);
      for (int i = 0; i < value.size(); ++i) node.push_back(to_yaml(value[i]));
      return node;
    case XmlRpc::XmlRpcValue::TypeStruct:
      node = YAML::Node(YAML::NodeType::Map);
      for (auto& member : value) node[member.first] = to_yaml(member.second);
      return node;
    default:
      return node;
  }
}

}  // namespace

Configuration read_configuration(const ros::NodeHandle& platoon) {
  XmlRpc::XmlRpcValue value;
  const std::string name = platoon.resolveName("configuration");
  if (!platoon.getParam("configuration", value)) {
    throw ConfigurationError({name + ": missing: must be the output of configure (platoon.launch sets it)"});
  }
  return parse_configuration(to_yaml(value));
}

}  // namespace platoon
