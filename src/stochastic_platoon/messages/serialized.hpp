#pragma once

#include <stochastic_platoon/ErrorStatistics.h>
#include <stochastic_platoon/Position.h>

#include <cstddef>
#include <string>

namespace platoon {

namespace detail {

/// Whether behind a std_msgs/Header and `fixed` bytes there are `arrays` arrays of doubles, each as long as it says.
bool holds_arrays(const std::string& bytes, std::size_t fixed, std::size_t arrays);

}  // namespace detail

/// Whether a serialized message holds the arrays that it announces. ROS takes the memory that is announced before it
/// looks whether so much is there: one flipped bit is gigabytes.
template <typename Message>
bool holds_its_arrays(const std::string&) {
  return true;  // none
}

template <>
inline bool holds_its_arrays<stochastic_platoon::Position>(const std::string& bytes) {
  return detail::holds_arrays(bytes, 8 + 4 + 8 + 8, 1);
}

template <>
inline bool holds_its_arrays<stochastic_platoon::ErrorStatistics>(const std::string& bytes) {
  return detail::holds_arrays(bytes, 8 + 8 + 1, 4);
}

}  // namespace platoon
