#include "stochastic_platoon/ros/messages/topics.hpp"

#include <gtest/gtest.h>

namespace platoon {
namespace {

using Kind = PlatoonTopic::Kind;

TEST(Topics, AreReadAsTheyAreNamed) {
  const auto position = parse_topic("/platoon/" + position_topic(12));
  ASSERT_TRUE(position);
  EXPECT_EQ(position->kind, Kind::position);
  EXPECT_EQ(position->name_space, "/platoon");
  EXPECT_EQ(position->vehicle, 12u);
  const auto received = parse_topic("/a/b/" + predecessor_position_topic(3));
  ASSERT_TRUE(received);
  EXPECT_EQ(received->kind, Kind::predecessor_position);
  EXPECT_EQ(received->name_space, "/a/b");
  EXPECT_EQ(received->vehicle, 3u);
  EXPECT_EQ(parse_topic("/platoon/configuration")->kind, Kind::configuration);
  EXPECT_EQ(parse_topic("/platoon/error_statistics")->kind, Kind::error_statistics);
}

TEST(Topics, OfOthersAreNone) {
  for (const char* other :
       {"/platoon/vehicle_x/position", "/platoon/vehicle_01/position", "/platoon/vehicle_-1/position",
        "/platoon/vehicle_1234567890/position", "/platoon/vehicle_1/positions", "/chatter", "", "/platoon/progress"}) {
    EXPECT_FALSE(parse_topic(other)) << other;
  }
}

// Regression: std::regex overflowed the stack.
TEST(Topics, MayHaveAnyLength) {
  const std::string name_space = "/" + std::string(100000, 'a');
  const auto position = parse_topic(name_space + "/vehicle_1/position");
  ASSERT_TRUE(position);
  EXPECT_EQ(position->name_space, name_space);
}

}  // namespace
}  // namespace platoon
