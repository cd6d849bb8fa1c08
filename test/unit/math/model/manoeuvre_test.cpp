#include "stochastic_platoon/math/model/manoeuvre.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "stochastic_platoon/math/model/vehicle.hpp"
#include "unit/paper_platoon.hpp"

namespace platoon {
namespace {

constexpr double kPeriod = 0.1;    // [s]
constexpr double kProfile = 20.0;  // [m/s]

Manoeuvre driving() {
  Manoeuvre manoeuvre(kPeriod);
  manoeuvre.next_speed(kProfile);
  return manoeuvre;
}

TEST(Manoeuvre, FollowsTheProfileAtFirst) {
  Manoeuvre manoeuvre(kPeriod);
  for (const double speed : {0.0, 20.0, -3.0}) EXPECT_EQ(manoeuvre.next_speed(speed), speed);
}

TEST(Manoeuvre, DrivesAtASpeedFromTheNextStepOn) {
  Manoeuvre manoeuvre = driving();
  manoeuvre.drive_at(31.5);
  for (int k = 0; k < 3; ++k) EXPECT_EQ(manoeuvre.next_speed(kProfile), 31.5);
}

TEST(Manoeuvre, BrakesEvenlyToAStandstill) {
  Manoeuvre manoeuvre = driving();
  manoeuvre.brake();
  for (int k = 1; k <= 60; ++k) EXPECT_NEAR(manoeuvre.next_speed(kProfile), std::max(0.0, 20.0 - 0.4 * k), 1e-12) << k;
  EXPECT_EQ(manoeuvre.next_speed(kProfile), 0.0);
  EXPECT_TRUE(manoeuvre.is_under_way());
}

TEST(Manoeuvre, SwingsSlowlyWithLimits) {
  Manoeuvre manoeuvre(kPeriod, {Interval{-6.0, 3.0}, {}});
  manoeuvre.next_speed(kProfile);
  manoeuvre.swing();
  double before = kProfile;
  for (int k = 1; k <= 200; ++k) {
    const double speed = manoeuvre.next_speed(kProfile);
    EXPECT_NEAR(speed, 20.0 + 2.0 * std::sin(2.0 * 3.141592653589793 * k / 100.0), 1e-12) << k;  // 10 s
    EXPECT_LT(std::abs(speed - before) / kPeriod, 1.26) << k;                                    // [m/s^2]
    before = speed;
  }
}

TEST(Manoeuvre, AcceleratesFromAnySpeed) {
  Manoeuvre manoeuvre = driving();
  manoeuvre.accelerate();
  for (int k = 1; k <= 60; ++k) EXPECT_NEAR(manoeuvre.next_speed(kProfile), std::min(30.0, 20.0 + 0.2 * k), 1e-12) << k;
  manoeuvre.accelerate();
  EXPECT_NEAR(manoeuvre.next_speed(kProfile), 30.2, 1e-12);
}

TEST(Manoeuvre, NamesItsBounds) {
  const ManoeuvreBounds of = Manoeuvre(kPeriod, {Interval{-3.0, 1.6}, Interval{0.0, 23.5}}).bounds();
  EXPECT_EQ(of.speed, (Interval{0.0, 23.5}));
  EXPECT_EQ(of.acceleration, (Interval{-3.0, 1.6}));
  EXPECT_EQ(of.braking, 3.0);
  EXPECT_EQ(of.speed_up, 1.6);
  EXPECT_EQ(of.back, (Interval{-2.0, 1.6}));
  EXPECT_DOUBLE_EQ(of.seconds, Manoeuvre::kSeconds);
  const ManoeuvreBounds free = driving().bounds();
  EXPECT_EQ(free.speed, (Interval{-Manoeuvre::kLargestSpeed, Manoeuvre::kLargestSpeed}));
  EXPECT_EQ(free.acceleration, Interval{});
  EXPECT_EQ(free.braking, Manoeuvre::kBraking);
  EXPECT_EQ(free.back, (Interval{-Manoeuvre::kAcceleration, Manoeuvre::kAcceleration}));
  EXPECT_DOUBLE_EQ(free.seconds, 1.0);
}

// Each manoeuvre stays within them, and reaches them.
TEST(Manoeuvre, KeepsItsBounds) {
  Manoeuvre manoeuvre(kPeriod, {Interval{-3.0, 1.6}, Interval{0.0, 23.5}});
  const ManoeuvreBounds of = manoeuvre.bounds();
  double before = manoeuvre.next_speed(kProfile);
  const auto drive = [&](int steps) {
    Interval found{0.0, 0.0};
    for (int k = 0; k < steps; ++k) {
      const double speed = manoeuvre.next_speed(kProfile), acceleration = (speed - before) / kPeriod;
      EXPECT_GE(speed, of.speed.lower);
      EXPECT_LE(speed, of.speed.upper);
      found = {std::min(found.lower, acceleration), std::max(found.upper, acceleration)};
      before = speed;
    }
    return found;
  };
  manoeuvre.brake();
  EXPECT_NEAR(drive(100).lower, -of.braking, 1e-9);
  manoeuvre.accelerate();
  EXPECT_NEAR(drive(100).upper, of.speed_up, 1e-9);
  manoeuvre.drive_at(50.0);
  EXPECT_NEAR(drive(100).upper, of.acceleration.upper, 1e-9);
  EXPECT_EQ(before, of.speed.upper);
  manoeuvre.cruise();
  EXPECT_NEAR(drive(100).lower, of.back.lower, 1e-9);
}

TEST(Manoeuvre, SwingsAboutTheSpeedOfTheProfile) {
  Manoeuvre manoeuvre = driving();
  manoeuvre.swing();
  double sum = 0.0, most = 0.0;
  for (int k = 1; k <= 30; ++k) {
    const double speed = manoeuvre.next_speed(kProfile);
    sum += speed - kProfile;
    most = std::max(most, std::abs(speed - kProfile));
    if (k % Manoeuvre::kPeriod == 0) {
      EXPECT_NEAR(sum, 0.0, 1e-12);
    }
  }
  EXPECT_NEAR(most, Manoeuvre::kAmplitude * std::sin(0.4 * 3.14159265358979), 1e-9);
}

TEST(Manoeuvre, CruisesBackToTheProfileAndEnds) {
  Manoeuvre manoeuvre = driving();
  manoeuvre.drive_at(15.1);
  manoeuvre.next_speed(kProfile);
  manoeuvre.cruise();
  for (int k = 1; k <= 25; ++k) {
    EXPECT_TRUE(manoeuvre.is_under_way()) << k;
    EXPECT_NEAR(manoeuvre.next_speed(kProfile), std::min(20.0, 15.1 + 0.2 * k), 1e-12);
  }
  EXPECT_FALSE(manoeuvre.is_under_way());
  EXPECT_EQ(manoeuvre.next_speed(18.0), 18.0);
}

TEST(Manoeuvre, RejectsAnInvalidSpeedAndContinues) {
  Manoeuvre manoeuvre = driving();
  manoeuvre.drive_at(25.0);
  for (const double speed : {std::nan(""), std::numeric_limits<double>::infinity(), -1001.0, 1e300})
    EXPECT_THROW(manoeuvre.drive_at(speed), std::invalid_argument) << speed;
  EXPECT_EQ(manoeuvre.next_speed(kProfile), 25.0);
  manoeuvre.drive_at(995.0);
  manoeuvre.next_speed(kProfile);
  EXPECT_THROW(manoeuvre.accelerate(), std::invalid_argument);
}

// The leader reaches a constant manoeuvre speed without an error, as double integral action ensures.
TEST(Manoeuvre, LeadsTheLeaderUntilItsNextStart) {
  const PlatoonModel model = paper_platoon();
  LeaderVehicle leader(model), undisturbed(model);
  leader.start();
  undisturbed.start();
  for (int k = 0; k < 100; ++k) ASSERT_EQ(leader.step(), undisturbed.step()) << k;
  leader.manoeuvre().drive_at(10.0);
  double before = leader.step();
  for (int k = 0; k < 100; ++k) before = leader.step();
  EXPECT_NEAR(leader.step() - before, 10.0 * model.sample_period, 1e-9);
  EXPECT_EQ(leader.start(), undisturbed.start());
  for (int k = 0; k < 100; ++k) ASSERT_EQ(leader.step(), undisturbed.step()) << k;
}

}  // namespace
}  // namespace platoon
