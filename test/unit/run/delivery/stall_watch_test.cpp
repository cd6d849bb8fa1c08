#include "stochastic_platoon/run/delivery/stall_watch.hpp"

#include <gtest/gtest.h>

namespace platoon {
namespace {

using Change = StallWatch::Change;

TEST(StallWatch, ReportsAStallOnceAndItsEndOnce) {
  StallWatch watch;
  watch.arrived(10.0);
  EXPECT_EQ(watch.look(11.9, 2.0), Change::none);
  EXPECT_EQ(watch.look(12.1, 2.0), Change::stalled);
  EXPECT_EQ(watch.look(13.0, 2.0), Change::none);
  watch.completed_step(13.5);
  EXPECT_EQ(watch.look(13.6, 2.0), Change::moving);
  EXPECT_EQ(watch.look(13.7, 2.0), Change::none);
}

TEST(StallWatch, ReportsOneStallWhileAttemptsMakeNoProgress) {
  StallWatch watch;
  watch.completed_step(10.0);
  EXPECT_EQ(watch.look(12.1, 2.0), Change::stalled);
  for (double attempt = 13.0; attempt < 40.0; attempt += 3.0) {
    watch.arrived(attempt);  // of the vehicles before the stopped one
    EXPECT_EQ(watch.look(attempt + 0.1, 2.0), Change::none);
    EXPECT_EQ(watch.look(attempt + 2.5, 2.0), Change::none);
    EXPECT_TRUE(watch.stalled());
  }
  watch.completed_step(41.0);
  EXPECT_EQ(watch.look(41.1, 2.0), Change::moving);
}

TEST(StallWatch, ReportsNoStallWhileMessagesOfALongStepArrive) {
  StallWatch watch;
  for (double now = 0.0; now < 20.0; now += 1.0) {
    watch.arrived(now);
    EXPECT_EQ(watch.look(now + 0.5, 2.0), Change::none);
  }
}

TEST(StallWatch, WaitsFromTheFirstLookIfNothingHasArrived) {
  StallWatch watch;
  EXPECT_FALSE(watch.last_arrival());
  EXPECT_EQ(watch.look(100.0, 2.0), Change::none);
  EXPECT_EQ(watch.look(102.1, 2.0), Change::stalled);
}

}  // namespace
}  // namespace platoon
