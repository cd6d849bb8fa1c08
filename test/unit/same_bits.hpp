#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <vector>

#include "stochastic_platoon/math/statistics/moment_table.hpp"
#include "stochastic_platoon/math/statistics/smallest_gaps.hpp"

namespace platoon {

/// Unlike ==, which is true for 0.0 and -0.0 and false for two NaNs.
inline bool same_bits(double left, double right) {
  return std::memcmp(&left, &right, sizeof left) == 0;
}

inline bool same_bits(const std::vector<double>& left, const std::vector<double>& right) {
  return std::equal(left.begin(), left.end(), right.begin(), right.end(),
                    [](double one, double other) { return same_bits(one, other); });
}

inline void expect_same_bits(const std::vector<Moments>& found, const std::vector<Moments>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t c = 0; c < found.size(); ++c) {
    const Moments &one = found[c], &other = expected[c];
    ASSERT_EQ(one.count, other.count) << "cell " << c;
    ASSERT_TRUE(same_bits(one.mean, other.mean)) << "cell " << c;
    ASSERT_TRUE(same_bits(one.squared_deviations, other.squared_deviations)) << "cell " << c;
    ASSERT_TRUE(same_bits(one.cubed_deviations, other.cubed_deviations)) << "cell " << c;
    ASSERT_TRUE(same_bits(one.fourth_deviations, other.fourth_deviations)) << "cell " << c;
  }
}

inline void expect_same_bits(const MomentTable& found, const MomentTable& expected) {
  EXPECT_EQ(found.cells(), expected.cells());
  ASSERT_EQ(found.blocks().size(), expected.blocks().size());
  for (auto one = found.blocks().begin(), other = expected.blocks().begin(); one != found.blocks().end();
       ++one, ++other) {
    const MomentBlock &block = one->second, &same = other->second;
    EXPECT_EQ(one->first, other->first);
    EXPECT_EQ(block.range.first, same.range.first);
    EXPECT_EQ(block.range.level, same.range.level);
    EXPECT_TRUE(same_bits(block.mean, same.mean));
    EXPECT_TRUE(same_bits(block.squared_deviations, same.squared_deviations));
    EXPECT_TRUE(same_bits(block.cubed_deviations, same.cubed_deviations));
    EXPECT_TRUE(same_bits(block.fourth_deviations, same.fourth_deviations));
  }
  expect_same_bits(found.totals(), expected.totals());
}

inline void expect_same_gaps(const GapTable& found, const GapTable& expected) {
  EXPECT_EQ(found.counting().bin_width, expected.counting().bin_width);
  EXPECT_EQ(found.counting().safe_gap, expected.counting().safe_gap);
  ASSERT_GT(expected.followers().size(), 0u);
  ASSERT_EQ(found.followers().size(), expected.followers().size());
  for (std::size_t i = 0; i < expected.followers().size(); ++i) {
    const FollowerGaps &one = found.followers()[i], &other = expected.followers()[i];
    EXPECT_EQ(one.smallest.gap, other.smallest.gap) << i;
    EXPECT_EQ(one.smallest.realization, other.smallest.realization) << i;
    EXPECT_EQ(one.smallest.step, other.smallest.step) << i;
    EXPECT_EQ(one.collisions, other.collisions) << i;
    EXPECT_EQ(one.unsafe, other.unsafe) << i;
    EXPECT_EQ(one.histogram, other.histogram) << i;
  }
}

}  // namespace platoon
