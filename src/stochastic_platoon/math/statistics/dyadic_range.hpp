#pragma once

#include <cstdint>
#include <vector>

namespace platoon {

/// Realizations first .. first + 2^level - 1, with first a multiple of 2^level: a node of the binary tree
/// over all realizations.
struct DyadicRange {
  std::uint64_t first;
  unsigned level;

  std::uint64_t size() const { return std::uint64_t{1} << level; }
  std::uint64_t end() const { return first + size(); }
  bool is_left_child() const { return (first >> level) % 2 == 0; }
};

/// The fewest dyadic ranges that tile first .. first + count - 1, in order.
std::vector<DyadicRange> dyadic_cover(std::uint64_t first, std::uint64_t count);

}  // namespace platoon
