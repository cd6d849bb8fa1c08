#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <string>

namespace platoon {

/// A file's content with one bit flipped.
inline std::string with_flipped_bit(std::string content, std::size_t bit) {
  content[bit / 8] = static_cast<char>(content[bit / 8] ^ (1 << bit % 8));
  return content;
}

/// Calls `check` with a damaged content and its description: a flipped bit in each byte, a cut before each byte, and an
/// additional byte. Stops at the first failure.
template <typename Check>
void for_each_damage(const std::string& content, const Check& check) {
  for (std::size_t place = 0; place < content.size() && !testing::Test::HasFailure(); ++place) {
    check(with_flipped_bit(content, 8 * place + place % 8), "bit flipped in byte " + std::to_string(place));
    check(content.substr(0, place), "cut off at byte " + std::to_string(place));
  }
  check(content + "x", "longer");
}

}  // namespace platoon
