#pragma once

#include <stochastic_platoon/ErrorStatistics.h>
#include <stochastic_platoon/Position.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace platoon {

namespace detail {

/// Size [bytes] of a message of a std_msgs/Header, `fixed` bytes and `arrays` arrays of doubles, from the lengths in
/// it; none if it ends before the last length.
std::optional<std::size_t> announced_size(std::string_view bytes, std::size_t fixed, std::size_t arrays);

constexpr std::size_t kFixedOfPosition = 8 + 4 + 8 + 8, kFixedOfErrorStatistics = 8 + 8 + 1;

}  // namespace detail

/// Whether a serialized message of this type that begins with `begin` may have `size` bytes, from the lengths in it.
bool may_have_size(const std::string& type, std::string_view begin, std::size_t size);

/// Whether a serialized message contains the arrays that it announces. ROS allocates the announced memory before it
/// checks the size: one flipped bit can cost gigabytes.
template <typename Message>
bool holds_its_arrays(std::string_view) {
  return true;  // no arrays
}

template <>
inline bool holds_its_arrays<stochastic_platoon::Position>(std::string_view bytes) {
  return detail::announced_size(bytes, detail::kFixedOfPosition, 1).value_or(SIZE_MAX) <= bytes.size();
}

template <>
inline bool holds_its_arrays<stochastic_platoon::ErrorStatistics>(std::string_view bytes) {
  return detail::announced_size(bytes, detail::kFixedOfErrorStatistics, 4).value_or(SIZE_MAX) <= bytes.size();
}

}  // namespace platoon
