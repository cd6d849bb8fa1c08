#pragma once

#include <cstddef>
#include <string>

namespace platoon {

/// "vehicle_3": the namespace of a vehicle's topics and its name in messages, notices and frames. 0 is the leader.
inline std::string vehicle_name(std::size_t vehicle) {
  return "vehicle_" + std::to_string(vehicle);
}

/// The topic on which input n of a follower arrives: the first position and the first control input of its predecessor
/// on `predecessor_position` and `predecessor_input`, any other on `inputs/<n>`. `carries(m, signal)`: whether input m
/// carries this signal of the predecessor.
template <class Carries>
std::string received_topic(std::size_t follower, std::size_t n, const Carries& carries) {
  for (const char* const signal : {"position", "input"}) {
    std::size_t first = 0;
    while (first <= n && !carries(first, signal)) ++first;
    if (first == n) return vehicle_name(follower) + "/predecessor_" + signal;
  }
  return vehicle_name(follower) + "/inputs/" + std::to_string(n);
}

}  // namespace platoon
