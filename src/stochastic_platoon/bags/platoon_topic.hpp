#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace platoon {

/// A topic of a platoon as bags name it: "/platoon/vehicle_3/position".
struct PlatoonTopic {
  enum class Kind { position, predecessor_position, error_statistics, configuration };
  Kind kind;
  std::string name_space;   ///< "/platoon"
  std::size_t vehicle = 0;  ///< of the first two kinds
};

/// None for a topic of anything else.
std::optional<PlatoonTopic> parse_topic(const std::string& topic);

}  // namespace platoon
