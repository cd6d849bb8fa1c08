#include "stochastic_platoon/messages/serialized.hpp"

#include <cstdint>
#include <cstring>

namespace platoon::detail {

bool holds_arrays(const std::string& bytes, std::size_t fixed, std::size_t arrays) {
  constexpr std::size_t kSequenceAndStamp = 4 + 8;
  std::size_t at = 0;
  const auto pass = [&bytes, &at](std::size_t count) {
    const bool there = count <= bytes.size() - at;
    if (there) at += count;
    return there;
  };
  // Passes what a length in front of it announces.
  const auto pass_announced = [&](std::size_t bytes_each) {
    std::uint32_t count = 0;
    const std::size_t place = at;
    if (!pass(sizeof count)) return false;
    std::memcpy(&count, bytes.data() + place, sizeof count);
    return pass(bytes_each * count);
  };
  bool there = pass(kSequenceAndStamp) && pass_announced(1) && pass(fixed);
  for (std::size_t array = 0; there && array < arrays; ++array) there = pass_announced(sizeof(double));
  return there;
}

}  // namespace platoon::detail
