#include "stochastic_platoon/ros/messages/topics.hpp"

#include <regex>

#include "stochastic_platoon/run/delivery/vehicle_name.hpp"

namespace platoon {

std::string position_topic(std::size_t vehicle) {
  return vehicle_name(vehicle) + "/position";
}

std::string predecessor_position_topic(std::size_t follower) {
  return vehicle_name(follower) + "/predecessor_position";
}

std::string input_topic(std::size_t vehicle) {
  return vehicle_name(vehicle) + "/input";
}

std::string predecessor_input_topic(std::size_t follower) {
  return vehicle_name(follower) + "/predecessor_input";
}

std::optional<PlatoonTopic> parse_topic(const std::string& topic) {
  static const std::regex vehicle_topic("(.*)/vehicle_(0|[1-9][0-9]{0,8})/(predecessor_)?(position|input)");
  static const std::regex other_topic("(.*)/(error_statistics|configuration|checksum)");
  std::smatch match;
  if (std::regex_match(topic, match, vehicle_topic)) {
    using Kind = PlatoonTopic::Kind;
    const bool received = match[3].matched;
    const Kind kind = match[4] == "input" ? (received ? Kind::predecessor_input : Kind::input)
                                          : (received ? Kind::predecessor_position : Kind::position);
    return PlatoonTopic{kind, match[1], std::stoul(match[2])};
  }
  if (std::regex_match(topic, match, other_topic)) {
    using Kind = PlatoonTopic::Kind;
    const Kind kind = match[2] == kErrorStatisticsTopic ? Kind::error_statistics
                      : match[2] == kConfigurationTopic ? Kind::configuration
                                                        : Kind::checksum;
    return PlatoonTopic{kind, match[1], 0};
  }
  return std::nullopt;
}

}  // namespace platoon
