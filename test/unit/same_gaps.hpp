#pragma once

#include <gtest/gtest.h>

#include <cstddef>

#include "stochastic_platoon/math/statistics/smallest_gaps.hpp"

namespace platoon {

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
