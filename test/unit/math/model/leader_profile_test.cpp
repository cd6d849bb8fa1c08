#include "stochastic_platoon/math/model/leader_profile.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "unit/messages.hpp"

namespace platoon {
namespace {

std::string rejection(const std::vector<SpeedChange>& changes, double sample_period) {
  return message_of<std::invalid_argument>([&] { LeaderProfile(changes, sample_period); });
}

TEST(LeaderProfile, IsZeroUpToStepZero) {
  const LeaderProfile leader({{0, 20.0}}, 0.1);
  for (const std::int64_t step : {-100, -1, 0}) EXPECT_EQ(leader.position(step), 0.0);
}

TEST(LeaderProfile, MovesByTheSpeedOfTheStepBefore) {
  const LeaderProfile leader({{0, 20.0}}, 0.1);
  EXPECT_DOUBLE_EQ(leader.position(1), 2.0);
  EXPECT_DOUBLE_EQ(leader.position(100), 200.0);
}

TEST(LeaderProfile, FollowsTheRecursionForEveryStepAndChange) {
  const std::vector<SpeedChange> changes = {{3, 12.5}, {4, -2.0}, {10, 0.0}, {25, 31.0}};
  const LeaderProfile leader(changes, 0.02);
  double position = 0.0, speed = 0.0;
  std::size_t next = 0;
  for (std::int64_t k = 0; k < 60; ++k) {
    EXPECT_NEAR(leader.position(k), position, 1e-13) << k;
    if (next < changes.size() && changes[next].from_step == k) speed = changes[next++].value;
    position += 0.02 * speed;
  }
}

TEST(LeaderProfile, HasNoDriftOverAVeryLongRun) {
  const LeaderProfile leader({{0, 20.0}, {std::int64_t{1} << 40, 10.0}}, 0.1);
  EXPECT_DOUBLE_EQ(leader.position((std::int64_t{1} << 40) + 10), std::ldexp(2.0, 40) + 10.0);
}

TEST(LeaderProfile, IsAtRestWithoutChanges) {
  EXPECT_EQ(LeaderProfile({}, 0.1).position(1000), 0.0);
  EXPECT_TRUE(LeaderProfile({}, 0.1).changes().empty());
}

TEST(LeaderProfile, NamesAnInvalidSamplePeriod) {
  for (const double period : {0.0, -0.1, std::nan(""), HUGE_VAL}) {
    EXPECT_EQ(rejection({{0, 20.0}}, period),
              "sample_period: " + std::to_string(period) + ": must be finite and > 0 [s]");
  }
}

TEST(LeaderProfile, NamesAStepThatIsOutOfOrder) {
  const std::string rule = ": must be >= 0 and increase from one entry to the next";
  EXPECT_EQ(rejection({{-1, 20.0}}, 0.1), "leader from_step: -1" + rule);
  EXPECT_EQ(rejection({{5, 20.0}, {5, 10.0}}, 0.1), "leader from_step: 5" + rule);
  EXPECT_EQ(rejection({{5, 20.0}, {4, 10.0}}, 0.1), "leader from_step: 4" + rule);
  EXPECT_EQ(rejection({{0, 20.0}, {7, 10.0}}, 0.1), "");
}

TEST(LeaderProfile, RejectsASpeedThatIsNotFinite) {
  EXPECT_EQ(rejection({{0, std::nan("")}}, 0.1), "leader speed: must be finite [m/s]");
  EXPECT_EQ(rejection({{0, 1.0}, {2, HUGE_VAL}}, 0.1), "leader speed: must be finite [m/s]");
}

}  // namespace
}  // namespace platoon
