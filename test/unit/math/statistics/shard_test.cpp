#include "stochastic_platoon/math/statistics/shard.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "stochastic_platoon/math/statistics/dyadic_range.hpp"

namespace platoon {
namespace {

void expect_tiles(std::uint64_t of, std::uint64_t realizations) {
  std::uint64_t next = 0;
  std::uint64_t grain = 1;
  while (2 * grain * 32 * of <= realizations) grain *= 2;
  for (std::uint64_t i = 0; i < of; ++i) {
    const RealizationRange range = range_of({i, of}, realizations);
    ASSERT_EQ(range.first, next) << i << "/" << of << " of " << realizations;
    ASSERT_LT(range.first, range.end);
    ASSERT_EQ(range.first % grain, 0u);
    const double fair = static_cast<double>(realizations) / static_cast<double>(of);
    ASSERT_LE(std::abs(static_cast<double>(range.size()) - fair), fair / 32.0 + 1.0);
    if (range.end < realizations) {
      ASSERT_LE(dyadic_cover(range.first, range.size()).size(), 14u);
    }
    next = range.end;
  }
  ASSERT_EQ(next, realizations);
}

TEST(RangeOf, TilesTheRealizationsForEveryNumberOfShards) {
  for (std::uint64_t of = 1; of < 70; ++of) {
    for (std::uint64_t realizations = of; realizations < 300; ++realizations) expect_tiles(of, realizations);
    for (const std::uint64_t realizations : {8191ul, 8192ul, 100000ul, 1000003ul, 1ul << 46})
      expect_tiles(of, realizations);
  }
  expect_tiles(1024, 1000000000);
  expect_tiles(kMostShards, 1ul << 46);
  expect_tiles(999983, (1ul << 46) - 1);
}

TEST(RangeOf, OfOneShardIsAll) {
  EXPECT_EQ(range_of({0, 1}, 12345).first, 0u);
  EXPECT_EQ(range_of({0, 1}, 12345).end, 12345u);
}

TEST(RangeOf, RejectsAnInvalidShard) {
  EXPECT_THROW(range_of({3, 3}, 100), std::invalid_argument);
  EXPECT_THROW(range_of({0, 0}, 100), std::invalid_argument);
  EXPECT_THROW(range_of({0, 101}, 100), std::invalid_argument);
  EXPECT_THROW(range_of({0, kMostShards + 1}, 1ul << 46), std::invalid_argument);
  EXPECT_NO_THROW(range_of({99, 100}, 100));
}

}  // namespace
}  // namespace platoon
