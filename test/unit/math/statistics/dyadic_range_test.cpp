#include "stochastic_platoon/math/statistics/dyadic_range.hpp"

#include <gtest/gtest.h>

#include <random>

namespace platoon {
namespace {

bool are_siblings(const DyadicRange& left, const DyadicRange& right) {
  return left.level == right.level && left.is_left_child() && left.end() == right.first;
}

void expect_cover(std::uint64_t first, std::uint64_t count) {
  std::uint64_t next = first;
  const std::vector<DyadicRange> cover = dyadic_cover(first, count);
  for (std::size_t j = 0; j < cover.size(); ++j) {
    ASSERT_EQ(cover[j].first, next);
    ASSERT_EQ(cover[j].first % cover[j].size(), 0u);
    ASSERT_FALSE(j > 0 && are_siblings(cover[j - 1], cover[j])) << "one range would do for both";
    next = cover[j].end();
  }
  ASSERT_EQ(next, first + count);
}

TEST(DyadicRange, KnowsItsSizeEndAndSide) {
  const DyadicRange range{24, 3};
  EXPECT_EQ(range.size(), 8u);
  EXPECT_EQ(range.end(), 32u);
  EXPECT_FALSE(range.is_left_child());
  EXPECT_TRUE((DyadicRange{16, 3}.is_left_child()));
  EXPECT_TRUE((DyadicRange{0, 0}.is_left_child()));
  EXPECT_FALSE((DyadicRange{1, 0}.is_left_child()));
}

TEST(DyadicCover, TilesEveryRangeWithTheFewestAlignedOnes) {
  for (std::uint64_t first = 0; first < 70; ++first) {
    for (std::uint64_t count = 0; count < 200; ++count) expect_cover(first, count);
  }
}

TEST(DyadicCover, TilesRandomLargeRanges) {
  std::mt19937_64 generator(1);
  for (int trial = 0; trial < 1000; ++trial) expect_cover(generator() >> 17, generator() >> (17 + trial % 40));
}

TEST(DyadicCover, OfTheFirstRealizationsHasOneRangePerBitOfTheirNumber) {
  EXPECT_TRUE(dyadic_cover(0, 0).empty());
  EXPECT_EQ(dyadic_cover(0, 8192).size(), 1u);
  EXPECT_EQ(dyadic_cover(0, 8191).size(), 13u);
  EXPECT_EQ(dyadic_cover(0, 100000).size(), 6u);
  EXPECT_EQ(dyadic_cover(0, std::uint64_t{1} << 46).size(), 1u);
}

}  // namespace
}  // namespace platoon
