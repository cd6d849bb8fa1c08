#include "stochastic_platoon/ros/messages/topics.hpp"
#include "stochastic_platoon/math/model/input.hpp"

#include <cstdlib>
#include <map>
#include <utility>

namespace platoon {

std::string sent_topic(const Input& input, std::size_t follower) {
  const std::size_t source = source_of(input, follower);
  return input.signal == InputSignal::input ? input_topic(source) : position_topic(source);
}

std::string received_topic(const VehicleModel& vehicle, std::size_t follower, std::size_t input) {
  return received_topic(follower, input, [&vehicle](std::size_t n, const std::string& signal) {
    return vehicle.inputs[n].ahead == 1 && signal == name_of(vehicle.inputs[n].signal);
  });
}

namespace {

// The number of at most nine digits that follows a prefix, if the name is exactly that.
std::optional<std::size_t> number_after(const std::string& prefix, const std::string& name) {
  if (name.compare(0, prefix.size(), prefix) != 0 || name.size() > prefix.size() + 9) return std::nullopt;
  const unsigned long number = std::strtoul(name.c_str() + prefix.size(), nullptr, 10);
  return name == prefix + std::to_string(number) ? std::make_optional<std::size_t>(number) : std::nullopt;
}

// The text before the last slash, and the name behind it.
std::optional<std::pair<std::string, std::string>> split(const std::string& topic) {
  const std::size_t slash = topic.rfind('/');
  if (slash == std::string::npos) return std::nullopt;
  return std::make_pair(topic.substr(0, slash), topic.substr(slash + 1));
}

}  // namespace

std::optional<PlatoonTopic> parse_topic(const std::string& topic) {
  using Kind = PlatoonTopic::Kind;
  static const std::map<std::string, Kind> kinds{{"position", Kind::position},
                                                 {"predecessor_position", Kind::predecessor_position},
                                                 {"input", Kind::input},
                                                 {"predecessor_input", Kind::predecessor_input},
                                                 {kErrorStatisticsTopic, Kind::error_statistics},
                                                 {kConfigurationTopic, Kind::configuration},
                                                 {kChecksumTopic, Kind::checksum}};
  const auto last = split(topic);
  if (!last) return std::nullopt;
  PlatoonTopic parsed{Kind::other_input, last->first};
  const auto kind = kinds.find(last->second);
  if (kind != kinds.end()) {
    parsed.kind = kind->second;
    if (parsed.kind >= Kind::error_statistics) return parsed;
  } else {
    const auto inputs = split(last->first);
    const std::optional<std::size_t> input = number_after("", last->second);
    if (!inputs || inputs->second != "inputs" || !input) return std::nullopt;
    parsed.name_space = inputs->first;
    parsed.input = *input;
  }
  const auto vehicle = split(parsed.name_space);
  const std::optional<std::size_t> number = vehicle ? number_after("vehicle_", vehicle->second) : std::nullopt;
  if (!number) return std::nullopt;
  parsed.name_space = vehicle->first;
  parsed.vehicle = *number;
  return parsed;
}

}  // namespace platoon
