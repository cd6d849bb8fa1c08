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

std::optional<PlatoonTopic> parse_topic(const std::string& topic) {
  static const std::regex vehicle_topic("(.*)/vehicle_(0|[1-9][0-9]{0,8})/(predecessor_)?position");
  static const std::regex other_topic("(.*)/(error_statistics|configuration|checksum)");
  std::smatch match;
  if (std::regex_match(topic, match, vehicle_topic)) {
    const auto kind = match[3].matched ? PlatoonTopic::Kind::predecessor_position : PlatoonTopic::Kind::position;
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
