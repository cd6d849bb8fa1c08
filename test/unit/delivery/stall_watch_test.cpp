#include "stochastic_platoon/delivery/stall_watch.hpp"

#include <gtest/gtest.h>

namespace platoon {
namespace {

using Change = StallWatch::Change;

TEST(StallWatch, TellsAStallOnceAndItsEndOnce) {
  StallWatch watch;
  watch.arrived(10.0);
  EXPECT_EQ(watch.look(11.9, 2.0), Change::none);
  EXPECT_EQ(watch.look(12.1, 2.0), Change::stalled);
  EXPECT_EQ(watch.look(13.0, 2.0), Change::none);
  watch.arrived(13.5);
  EXPECT_EQ(watch.look(13.6, 2.0), Change::moving);
  EXPECT_EQ(watch.look(13.7, 2.0), Change::none);
}

TEST(StallWatch, WaitsFromTheFirstLookWhereNothingHasEverArrived) {
  StallWatch watch;
  EXPECT_FALSE(watch.last_arrival());
  EXPECT_EQ(watch.look(100.0, 2.0), Change::none);
  EXPECT_EQ(watch.look(102.1, 2.0), Change::stalled);
}

}  // namespace
}  // namespace platoon
