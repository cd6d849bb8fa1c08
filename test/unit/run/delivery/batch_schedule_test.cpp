#include "stochastic_platoon/run/delivery/batch_schedule.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace platoon {
namespace {

TEST(BatchSchedule, DividesTheRealizationsIntoBatches) {
  const BatchSchedule schedule{20, 8, 3};
  EXPECT_EQ(schedule.size(0), 8u);
  EXPECT_EQ(schedule.next(0), 8u);
  EXPECT_EQ(schedule.size(8), 8u);
  EXPECT_EQ(schedule.next(8), 16u);
  EXPECT_EQ(schedule.size(16), 4u);
  EXPECT_EQ(schedule.next(16), 20u);
  EXPECT_EQ(schedule.size(20), 0u);
}

TEST(BatchSchedule, RepeatsTheNoiseOfABatchButNotOfAnEndlessOne) {
  const BatchSchedule schedule{20, 8, 3}, endless{1, 1, 0};
  EXPECT_EQ(first_noise_realization(schedule, {1, 8, 2}), 8u);
  EXPECT_EQ(first_noise_realization(schedule, {7, 8, 2}), 8u);
  EXPECT_EQ(first_noise_realization(endless, {1, 0, 2}), 0u);
  EXPECT_EQ(first_noise_realization(endless, {7, 0, 2}), 6u);
}

TEST(BatchSchedule, ContinuesFromAnyRealization) {
  const BatchSchedule schedule{20, 8, 3};
  EXPECT_EQ(schedule.next(5), 13u);
  EXPECT_EQ(schedule.size(13), 7u);
  EXPECT_EQ(schedule.next(13), 20u);
}

TEST(BatchSchedule, IsCompleteAfterTheLastRealization) {
  const BatchSchedule schedule{20, 8, 3};
  EXPECT_FALSE(schedule.is_complete(16));
  EXPECT_TRUE(schedule.is_complete(20));
}

TEST(BatchSchedule, EndsABatchWithItsLastStep) {
  const BatchSchedule schedule{20, 8, 3};
  EXPECT_FALSE(schedule.is_last_step(kInitialStep));
  EXPECT_FALSE(schedule.is_last_step(1));
  EXPECT_TRUE(schedule.is_last_step(2));
  EXPECT_TRUE((BatchSchedule{20, 8, 1}.is_last_step(0)));
}

TEST(BatchSchedule, CountsTheStepsAReportCovers) {
  const BatchSchedule schedule{20, 8, 3};
  EXPECT_EQ(steps_covered(schedule, 0, {1, 0, kNothingYet}), 0);
  EXPECT_EQ(steps_covered(schedule, 0, {1, 0, kInitialStep}), 1);
  EXPECT_EQ(steps_covered(schedule, 0, {1, 8, 1}), 4 + 3);
  EXPECT_EQ(steps_covered(schedule, 0, {1, 20, kNothingYet}), 12);
  EXPECT_EQ(steps_covered(schedule, 8, {1, 16, kInitialStep}), 4 + 1);
  EXPECT_EQ(steps_covered(schedule, 8, {1, 0, 2}), 0);
}

// After the largest number the leader would have no next attempt.
TEST(BatchSchedule, RejectsAReportOfAnInvalidAttempt) {
  const BatchSchedule schedule{20, 8, 3};
  EXPECT_TRUE(may_be_reported(schedule, {kLastAttempt, 0, 0}));
  EXPECT_FALSE(may_be_reported(schedule, {kLastAttempt + 1, 0, 0}));
  EXPECT_FALSE(may_be_reported(schedule, {std::numeric_limits<std::uint32_t>::max(), 0, 0}));
}

TEST(BatchSchedule, OfZeroStepsIsEndless) {
  const BatchSchedule schedule{1, 1, 0};
  EXPECT_TRUE(schedule.endless());
  EXPECT_FALSE(schedule.is_last_step(kInitialStep));
  EXPECT_FALSE(schedule.is_last_step(1000000));
}

}  // namespace
}  // namespace platoon
