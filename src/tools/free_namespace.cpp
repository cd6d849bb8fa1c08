#include "tools/free_namespace.hpp"

#include <ros/init.h>
#include <ros/names.h>
#include <ros/param.h>

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "stochastic_platoon/ros/messages/topics.hpp"
#include "stochastic_platoon/ros/transport/publishers.hpp"
#include "stochastic_platoon/run/configuration/configuration_error.hpp"
#include "stochastic_platoon/run/configuration/launch_arguments.hpp"

namespace platoon {

namespace {

// Joins the master of this launch and returns the namespace of its platoon, resolved; none without a launch.
std::optional<std::string> joined_namespace(const CommandLine& line) {
  if (roslaunch_process() == 0) return std::nullopt;
  const char* environment = std::getenv("ROS_MASTER_URI");
  ros::init(ros::M_string{{"__master", master_address(command_line(), environment)}}, "configure",
            ros::init_options::AnonymousName | ros::init_options::NoRosout | ros::init_options::NoSigintHandler);
  std::string problem;
  if (!ros::names::validate(line["ns"], problem)) throw ConfigurationError({"ns: " + line["ns"] + ": " + problem});
  return ros::names::resolve(line["ns"]);
}

// A live publisher of one of the selected topics of a platoon.
template <typename Selected>
std::optional<TopicPublisher> publisher_in(const std::string& name_space, const Selected& selected) {
  return live_publisher([&](const std::string& name) {
    const std::optional<PlatoonTopic> topic = parse_topic(name);
    return topic && topic->name_space == name_space && selected(*topic);
  });
}

// Throws ConfigurationError if a vehicle runs already that this launch would start.
void require_free_vehicles_in(const std::string& name_space, const CommandLine& line,
                              const std::vector<std::size_t>& external) {
  const auto number = [&line](const char* key) { return std::strtoull(line[key].c_str(), nullptr, 10); };
  const auto vehicle = publisher_in(name_space, [&](const PlatoonTopic& topic) {
    return topic.kind == PlatoonTopic::Kind::position && topic.vehicle >= number("first") &&
           topic.vehicle <= number("last") && !std::binary_search(external.begin(), external.end(), topic.vehicle);
  });
  if (!vehicle) return;
  throw ConfigurationError({vehicle->topic + ": node " + vehicle->node +
                            " publishes it already: must be outside first:= .. last:=, or in external:="});
}

}  // namespace

void require_free_vehicles(const CommandLine& line, const std::vector<std::size_t>& external) {
  if (const auto name_space = joined_namespace(line)) require_free_vehicles_in(*name_space, line, external);
}

void require_free_namespace(const CommandLine& line, const std::optional<std::vector<std::size_t>>& external) {
  const std::optional<std::string> name_space = joined_namespace(line);
  if (!name_space) return;
  using Topic = PlatoonTopic;
  // Followers may outlive runs.
  const auto running = publisher_in(*name_space, [](const Topic& topic) {
    const bool of_vehicle = topic.kind == Topic::Kind::position || topic.kind == Topic::Kind::input;
    return !of_vehicle || topic.vehicle == 0;
  });
  if (running) {
    std::string text;
    ros::param::get(*name_space + "/configuration", text);
    const auto configuration = nlohmann::json::parse(text, nullptr, false);
    const std::string output =
        configuration.is_object() ? configuration.value(nlohmann::json::json_pointer("/run/output"), "") : "";
    throw ConfigurationError({"ns: " + line["ns"] + ": a platoon runs in it already (node " + running->node +
                              ", results in " + output +
                              "): must be another namespace, as in ns:=platoon2, or wait for its end"});
  }
  if (external) require_free_vehicles_in(*name_space, line, *external);
}

}  // namespace platoon
