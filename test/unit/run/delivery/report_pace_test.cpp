#include "stochastic_platoon/run/delivery/report_pace.hpp"

#include <gtest/gtest.h>

namespace platoon {
namespace {

const BatchSchedule kSchedule{20, 8, 30};

ReportPace reported(const Acknowledgement& latest, std::int64_t window = 16) {
  ReportPace pace(kSchedule, window);
  pace.note_report(latest);
  return pace;
}

TEST(ReportPace, ReportsTheFirstStepOfAnAttemptAtOnce) {
  const ReportPace pace = reported({1, 0, 12});
  EXPECT_TRUE(pace.is_due({2, 0, kNothingYet}));
  EXPECT_TRUE(pace.is_due({2, 0, kInitialStep}));
  EXPECT_TRUE(reported({2, 0, kNothingYet}).is_due({2, 0, kInitialStep}));
}

TEST(ReportPace, ReportsAfterAQuarterOfTheWindow) {
  const ReportPace pace = reported({1, 8, 5});
  EXPECT_FALSE(pace.is_due({1, 8, 5}));
  EXPECT_FALSE(pace.is_due({1, 8, 8}));
  EXPECT_TRUE(pace.is_due({1, 8, 9}));
}

TEST(ReportPace, CountsStepsAcrossBatches) {
  const ReportPace pace = reported({1, 0, 27});
  EXPECT_FALSE(pace.is_due({1, 8, kNothingYet}));  // steps 28 and 29
  EXPECT_FALSE(pace.is_due({1, 8, -1}));
  EXPECT_TRUE(pace.is_due({1, 8, 0}));
}

TEST(ReportPace, ReportsTheEndOfTheRunAtOnce) {
  EXPECT_TRUE(reported({1, 16, 28}).is_due({1, 20, kNothingYet}));
  EXPECT_FALSE(reported({1, 20, kNothingYet}).is_due({1, 20, kNothingYet}));
}

TEST(ReportPace, ReportsEveryStepOfAWindowBelowEightSteps) {
  for (const std::int64_t window : {1, 4, 7}) EXPECT_TRUE(reported({1, 0, 3}, window).is_due({1, 0, 4}));
  EXPECT_FALSE(reported({1, 0, 3}, 8).is_due({1, 0, 4}));
}

// Otherwise the leader would wait for a report until the next heartbeat.
TEST(ReportPace, NeverLeavesAWholeWindowUnreported) {
  for (std::int64_t window = 1; window <= 29; ++window) {
    EXPECT_TRUE(reported({1, 0, kInitialStep}, window).is_due({1, 0, kInitialStep + window})) << window;
  }
}

}  // namespace
}  // namespace platoon
