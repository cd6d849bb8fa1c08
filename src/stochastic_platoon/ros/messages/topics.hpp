#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace platoon {

/// Topics relative to the platoon's namespace.
std::string position_topic(std::size_t vehicle);               ///< "vehicle_3/position"
std::string predecessor_position_topic(std::size_t follower);  ///< "vehicle_3/predecessor_position"
std::string input_topic(std::size_t vehicle);                  ///< "vehicle_3/input"
std::string predecessor_input_topic(std::size_t follower);     ///< "vehicle_3/predecessor_input"
constexpr char kProgressTopic[] = "progress";
constexpr char kErrorStatisticsTopic[] = "error_statistics";
constexpr char kOverviewTopic[] = "overview";
constexpr char kConfigurationTopic[] = "configuration";
constexpr char kChecksumTopic[] = "checksum";  ///< in recordings only
constexpr char kSnapshotTopic[] = "snapshot";
constexpr char kPredecessorSnapshotTopic[] = "predecessor_snapshot";
constexpr char kChangeRunService[] = "change_run";

/// A topic of a platoon as bags name it: "/platoon/vehicle_3/position".
struct PlatoonTopic {
  enum class Kind {
    position,
    predecessor_position,
    input,
    predecessor_input,
    error_statistics,
    configuration,
    checksum
  };
  Kind kind;
  std::string name_space;   ///< "/platoon"
  std::size_t vehicle = 0;  ///< of the first four kinds
};

/// None if the topic does not belong to a platoon.
std::optional<PlatoonTopic> parse_topic(const std::string& topic);

}  // namespace platoon
