#include "stochastic_platoon/ros/messages/topics.hpp"

#include <cstdio>
#include <map>

namespace platoon {

std::optional<PlatoonTopic> parse_topic(const std::string& topic) {
  using Kind = PlatoonTopic::Kind;
  static const std::map<std::string, Kind> kinds{{"position", Kind::position},
                                                 {"predecessor_position", Kind::predecessor_position},
                                                 {"input", Kind::input},
                                                 {"predecessor_input", Kind::predecessor_input},
                                                 {kErrorStatisticsTopic, Kind::error_statistics},
                                                 {kConfigurationTopic, Kind::configuration},
                                                 {kChecksumTopic, Kind::checksum}};
  const std::size_t end = topic.rfind('/');
  if (end == std::string::npos) return std::nullopt;
  const auto kind = kinds.find(topic.substr(end + 1));
  if (kind == kinds.end()) return std::nullopt;
  const std::string name_space = topic.substr(0, end);
  if (kind->second >= Kind::error_statistics) return PlatoonTopic{kind->second, name_space};
  const std::size_t begin = name_space.rfind('/');
  if (begin == std::string::npos) return std::nullopt;
  const std::string name = name_space.substr(begin + 1);
  unsigned long vehicle = 0;
  if (std::sscanf(name.c_str(), "vehicle_%9lu", &vehicle) != 1 || name != vehicle_name(vehicle)) return std::nullopt;
  return PlatoonTopic{kind->second, name_space.substr(0, begin), vehicle};
}

}  // namespace platoon
