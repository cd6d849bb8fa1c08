#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <tuple>

#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/run/delivery/vehicle_name.hpp"

namespace platoon {

/// Topics relative to the platoon's namespace.
inline std::string position_topic(std::size_t vehicle) {
  return vehicle_name(vehicle) + "/position";
}
inline std::string predecessor_position_topic(std::size_t follower) {
  return vehicle_name(follower) + "/predecessor_position";
}
inline std::string input_topic(std::size_t vehicle) {
  return vehicle_name(vehicle) + "/input";
}
inline std::string predecessor_input_topic(std::size_t follower) {
  return vehicle_name(follower) + "/predecessor_input";
}

/// The topics that an input of a follower comes from and arrives on.
std::string sent_topic(const Input& input, std::size_t follower);
std::string received_topic(const VehicleModel& vehicle, std::size_t follower, std::size_t input);

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
    other_input,  ///< `inputs/<n>`
    error_statistics,
    configuration,
    checksum
  };
  Kind kind;
  std::string name_space;   ///< "/platoon"
  std::size_t vehicle = 0;  ///< of the kinds before error_statistics
  std::size_t input = 0;    ///< n of `inputs/<n>`

  /// What a topic carries, in whatever namespace.
  using Key = std::tuple<Kind, std::size_t, std::size_t>;
  Key key() const { return {kind, vehicle, input}; }
};

/// None if the topic does not belong to a platoon.
std::optional<PlatoonTopic> parse_topic(const std::string& topic);

}  // namespace platoon
