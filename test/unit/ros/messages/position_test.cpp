#include "stochastic_platoon/ros/messages/position.hpp"

#include <gtest/gtest.h>

#include <boost/make_shared.hpp>
#include <boost/weak_ptr.hpp>
#include <cmath>
#include <limits>

namespace platoon {
namespace {

using stochastic_platoon::Position;

TEST(PositionMessage, HasTheIdThatWasSet) {
  Position message;
  set_id(77, {3, 512, 12}, message);
  EXPECT_EQ(message.run, 77u);
  EXPECT_EQ(id_of(message).attempt, 3u);
  EXPECT_EQ(id_of(message).first_realization, 512u);
  EXPECT_EQ(id_of(message).step, 12);
}

TEST(PositionMessage, IsDescribedByIdSizeAndFiniteness) {
  Position message;
  set_id(77, {3, 512, 12}, message);
  message.position = {1.0, 2.0, 3.0};
  EXPECT_EQ(descriptor_of(message).id.step, 12);
  EXPECT_EQ(descriptor_of(message).size, 3u);
  EXPECT_TRUE(descriptor_of(message).finite);
  message.position[1] = std::nan("");
  EXPECT_FALSE(descriptor_of(message).finite);
}

TEST(PositionMessage, SharesItsArrayAndLivesAsLongAsItIsUsed) {
  auto message = boost::make_shared<Position>();
  message->position = {1.0, 2.0};
  const double* data = message->position.data();
  const boost::weak_ptr<Position> alive = message;
  Positions shared = positions_of(message);
  message.reset();
  EXPECT_EQ(shared->data(), data);
  EXPECT_FALSE(alive.expired());
  shared.reset();
  EXPECT_TRUE(alive.expired());
}

TEST(PlatoonPeriod, IsTheNearestWholeNumberOfNanoseconds) {
  EXPECT_EQ(platoon_period(0.1).toNSec(), 100000000);
  EXPECT_EQ(platoon_period(1e-9).toNSec(), 1);
  EXPECT_EQ(platoon_period(1.0 / 3.0).toNSec(), 333333333);
}

TEST(Later, IsOnePeriodOn) {
  EXPECT_EQ(later(ros::Time(3, 950000000), platoon_period(0.1)), ros::Time(4, 50000000));
}

TEST(Later, SaturatesAtTheLargestStamp) {
  EXPECT_EQ(later(ros::TIME_MAX, platoon_period(1e6)), ros::TIME_MAX);
  EXPECT_EQ(later(ros::Time(0xffffffff, 0), platoon_period(1e6)), ros::TIME_MAX);
}

// A message on the wire may have any seconds and nanoseconds.
TEST(Later, AcceptsAnInvalidTime) {
  ros::Time none;
  none.sec = none.nsec = 0xffffffff;
  EXPECT_EQ(later(none, platoon_period(0.1)), ros::TIME_MAX);
  EXPECT_EQ(platoon_time(none.toNSec()), ros::TIME_MAX);
}

TEST(AllFinite, IsTrueIfNoNumberIsInfiniteOrNaN) {
  using Limits = std::numeric_limits<double>;
  EXPECT_TRUE(all_finite({}));
  EXPECT_TRUE(all_finite({0.0, -0.0, Limits::max(), -Limits::max(), Limits::min(), Limits::denorm_min(), -1.5}));
  for (const double bad :
       {Limits::infinity(), -Limits::infinity(), Limits::quiet_NaN(), -Limits::quiet_NaN(), Limits::signaling_NaN()}) {
    EXPECT_FALSE(all_finite({bad}));
    EXPECT_FALSE(all_finite({1.0, 2.0, bad, 4.0}));
  }
}

}  // namespace
}  // namespace platoon
