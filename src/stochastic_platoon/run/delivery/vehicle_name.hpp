#pragma once

#include <cstddef>
#include <string>

namespace platoon {

/// "vehicle_3": the namespace of a vehicle's topics and its name in messages, notices and frames. 0 is the leader.
inline std::string vehicle_name(std::size_t vehicle) {
  return "vehicle_" + std::to_string(vehicle);
}

}  // namespace platoon
