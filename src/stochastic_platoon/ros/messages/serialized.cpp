#include "stochastic_platoon/ros/messages/serialized.hpp"

#include <ros/message_traits.h>

#include <cstdint>
#include <cstring>

namespace platoon {

namespace detail {

std::optional<std::size_t> announced_size(std::string_view bytes, std::size_t fixed, std::size_t arrays) {
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
  at += fixed;
  for (std::size_t array = 0; array < arrays; ++array) {
    if (!pass(sizeof(double))) return std::nullopt;
  }
  return at;
}

}  // namespace detail

bool may_have_size(const std::string& type, std::string_view begin, std::size_t size) {
  using stochastic_platoon::ErrorStatistics;
  using stochastic_platoon::Position;
  std::optional<std::size_t> announced;
  if (type == ros::message_traits::datatype<Position>())
    announced = detail::announced_size(begin, detail::kFixedOfPosition, 1);
  if (type == ros::message_traits::datatype<ErrorStatistics>())
    announced = detail::announced_size(begin, detail::kFixedOfErrorStatistics, 4);
  return !announced || *announced == size;
}

}  // namespace platoon
