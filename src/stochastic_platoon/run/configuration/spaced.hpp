#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace platoon {

/// Equally spaced values including both ends; a single value is `from`.
struct Spaced {
  double from, to;
  std::uint64_t count;

  double at(std::uint64_t index) const;
};

/// FROM:TO:COUNT with finite FROM <= TO and COUNT >= 1; none for any other text.
std::optional<Spaced> parse_spaced(const std::string& text);

}  // namespace platoon
