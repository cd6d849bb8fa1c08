#include "stochastic_platoon/math/statistics/dyadic_range.hpp"

namespace platoon {

std::vector<DyadicRange> dyadic_cover(std::uint64_t first, std::uint64_t count) {
  std::vector<DyadicRange> cover;
  const std::uint64_t end = first + count;
  while (first < end) {
    DyadicRange range{first, 0};
    while (range.level < 62) {
      const DyadicRange wider{first, range.level + 1};
      if (first % wider.size() != 0 || wider.end() > end) break;
      range = wider;
    }
    cover.push_back(range);
    first = range.end();
  }
  return cover;
}

}  // namespace platoon
