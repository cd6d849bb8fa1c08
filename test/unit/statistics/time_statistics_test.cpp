#include "stochastic_platoon/statistics/time_statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace platoon {
namespace {

TEST(TimeStatistics, LeaveTheBurnInOut) {
  TimeStatistics statistics(1, 10);
  for (std::int64_t k = 0; k < 14; ++k) statistics.add(1, k, k < 10 ? 1e6 : static_cast<double>(k));
  EXPECT_EQ(statistics.moments()[0].count, 4u);
  EXPECT_DOUBLE_EQ(statistics.moments()[0].mean, 11.5);
  EXPECT_DOUBLE_EQ(statistics.moments()[0].variance(), 5.0 / 3.0);
}

TEST(TimeStatistics, WithoutBurnInTakeEveryStep) {
  TimeStatistics statistics(1, 0);
  statistics.add(1, 0, 3.0);
  EXPECT_EQ(statistics.moments()[0].count, 1u);
}

TEST(TimeStatistics, AreUndefinedDuringTheBurnIn) {
  TimeStatistics statistics(1, 10);
  statistics.add(1, 9, 3.0);
  EXPECT_EQ(statistics.moments()[0].count, 0u);
  EXPECT_TRUE(std::isnan(statistics.moments()[0].variance()));
}

TEST(TimeStatistics, KeepFollowersApart) {
  TimeStatistics statistics(3, 0);
  statistics.add(1, 0, 1.0);
  statistics.add(3, 0, 5.0);
  statistics.add(3, 1, 7.0);
  ASSERT_EQ(statistics.moments().size(), 3u);
  EXPECT_EQ(statistics.moments()[0].mean, 1.0);
  EXPECT_EQ(statistics.moments()[1].count, 0u);
  EXPECT_EQ(statistics.moments()[2].mean, 6.0);
  EXPECT_THROW(statistics.add(4, 0, 1.0), std::out_of_range);
  EXPECT_THROW(statistics.add(0, 0, 1.0), std::out_of_range);
}

TEST(TimeStatistics, BeginAnewWithTheSameBurnIn) {
  TimeStatistics statistics(2, 5);
  for (std::int64_t k = 0; k < 8; ++k) statistics.add(2, k, 4.0);
  statistics.restart();
  ASSERT_EQ(statistics.moments().size(), 2u);
  EXPECT_EQ(statistics.moments()[1].count, 0u);
  for (std::int64_t k = 0; k < 6; ++k) statistics.add(2, k, 9.0);
  EXPECT_EQ(statistics.moments()[1].count, 1u);
}

}  // namespace
}  // namespace platoon
