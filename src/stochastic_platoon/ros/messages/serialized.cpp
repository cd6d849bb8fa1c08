#include "stochastic_platoon/ros/messages/serialized.hpp"

#include <ros/message_traits.h>
#include <stochastic_platoon/ErrorStatistics.h>
#include <stochastic_platoon/Position.h>

#include <cstdint>
#include <cstring>
#include <optional>

namespace platoon {

namespace {

// A message of a std_msgs/Header, fields of fixed size, and arrays of doubles.
struct Layout {
  std::size_t fixed_bytes, arrays;
};

// None for types without arrays.
std::optional<Layout> layout_of(std::string_view type) {
  if (type == ros::message_traits::datatype<stochastic_platoon::Position>()) return Layout{8 + 4 + 8 + 8, 1};
  if (type == ros::message_traits::datatype<stochastic_platoon::ErrorStatistics>()) return Layout{8 + 8 + 1, 4};
  return std::nullopt;
}

// Size [bytes] of a message that begins with `bytes`, from the lengths in it; none if they end before the last length.
std::optional<std::size_t> announced_size(const Layout& layout, std::string_view bytes) {
  constexpr std::size_t kSequenceAndStamp = 4 + 8;
  std::size_t at = kSequenceAndStamp;
  // Skips a length and the data that it announces.
  const auto pass = [&bytes, &at](std::size_t bytes_each) {
    std::uint32_t count = 0;
    if (at > bytes.size() || bytes.size() - at < sizeof count) return false;
    std::memcpy(&count, bytes.data() + at, sizeof count);
    at += sizeof count + bytes_each * count;
    return true;
  };
  if (!pass(1)) return std::nullopt;
  at += layout.fixed_bytes;
  for (std::size_t array = 0; array < layout.arrays; ++array) {
    if (!pass(sizeof(double))) return std::nullopt;
  }
  return at;
}

}  // namespace

bool may_have_size(std::string_view type, std::string_view begin, std::size_t size) {
  const std::optional<Layout> layout = layout_of(type);
  return !layout || announced_size(*layout, begin).value_or(size) == size;
}

bool holds_its_arrays(std::string_view type, std::string_view bytes) {
  const std::optional<Layout> layout = layout_of(type);
  return !layout || announced_size(*layout, bytes).value_or(SIZE_MAX) <= bytes.size();
}

}  // namespace platoon
