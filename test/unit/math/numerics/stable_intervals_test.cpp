#include "stochastic_platoon/math/numerics/stable_intervals.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace platoon {
namespace {

const std::vector<double> kPlaces{0.5, 1.5, 2.5, 3.5};

// Stable up to 2.2, where the necessary margin passes zero and the full one jumps.
TEST(StableIntervals, EndAtAJumpThatTheNecessaryMarginShows) {
  int evaluations = 0;
  const auto margin = [&evaluations](double x) {
    ++evaluations;
    return x < 2.2 ? 0.7 : 0.0;
  };
  const std::vector<StableInterval> found = stable_intervals(margin, kPlaces, [](double x) { return 2.2 - x; });
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found.front().from, 0.5);
  EXPECT_NEAR(found.front().to, 2.2, 1e-11);
  EXPECT_LT(found.front().to, 2.2);
  EXPECT_EQ(evaluations, 3) << "at two places and beside the border";
}

TEST(StableIntervals, EndWhereTheFullMarginDoesBeforeTheNecessaryOne) {
  const auto necessary = [](double x) { return x - 0.7; };
  const std::vector<StableInterval> found = stable_intervals([](double x) { return x - 1.25; }, kPlaces, necessary);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found.front().from, 1.25, 1e-11);
  EXPECT_EQ(found.front().to, 3.5);
}

TEST(StableIntervals, EndAtAJumpWithoutANecessaryMargin) {
  const std::vector<StableInterval> found =
      stable_intervals([](double x) { return x > 1.1 && x < 2.9 ? 1.0 : -1.0; }, kPlaces);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found.front().from, 1.1, 1e-11);
  EXPECT_NEAR(found.front().to, 2.9, 1e-11);
}

// A pole on the unit circle at the border.
TEST(StableIntervals, EndCorrectlyAtAnInfiniteMargin) {
  const auto margin = [](double x) {
    if (x < 2.2) return 130.0;
    return x < 2.2 + 1e-10 ? -std::numeric_limits<double>::infinity() : 0.004 * (2.2 - x);
  };
  const std::vector<StableInterval> found = stable_intervals(margin, kPlaces);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found.front().to, 2.2, 1e-11);
}

}  // namespace
}  // namespace platoon
