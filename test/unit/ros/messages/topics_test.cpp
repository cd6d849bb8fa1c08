#include "stochastic_platoon/ros/messages/topics.hpp"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "unit/paper_platoon.hpp"

namespace platoon {
namespace {

using Kind = PlatoonTopic::Kind;

TEST(Topics, AreParsedFromTheirNames) {
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
  const auto input = parse_topic("/a/b/vehicle_3/inputs/11");
  ASSERT_TRUE(input);
  EXPECT_EQ(input->kind, Kind::other_input);
  EXPECT_EQ(input->name_space, "/a/b");
  EXPECT_EQ(input->vehicle, 3u);
  EXPECT_EQ(input->input, 11u);
  EXPECT_EQ(parse_topic("/platoon/configuration")->kind, Kind::configuration);
  EXPECT_EQ(parse_topic("/platoon/error_statistics")->kind, Kind::error_statistics);
}

TEST(Topics, OfThePredecessorKeepTheirNamesBesideOtherInputs) {
  VehicleModel vehicle = paper_platoon(1.0).default_vehicle();
  vehicle.inputs = {{InputSignal::input, 0.0, 1.0, {}, Input::kLeader},
                    {InputSignal::position, 0.0, 0.5, {}, 2},
                    {InputSignal::position, 0.0, 0.5},
                    {InputSignal::input},
                    {InputSignal::speed},
                    {InputSignal::position, 0.0, 0.0}};
  const std::vector<std::pair<std::string, std::string>> expected = {
      {"vehicle_0/input", "vehicle_7/inputs/0"},
      {"vehicle_5/position", "vehicle_7/inputs/1"},
      {"vehicle_6/position", "vehicle_7/predecessor_position"},
      {"vehicle_6/input", "vehicle_7/predecessor_input"},
      {"vehicle_6/position", "vehicle_7/inputs/4"},
      {"vehicle_6/position", "vehicle_7/inputs/5"}};
  for (std::size_t n = 0; n < expected.size(); ++n) {
    EXPECT_EQ(sent_topic(vehicle.inputs[n], 7), expected[n].first) << n;
    EXPECT_EQ(received_topic(vehicle, 7, n), expected[n].second) << n;
  }
  EXPECT_EQ(sent_topic(vehicle.inputs[1], 1), "vehicle_0/position");
}

TEST(Topics, OfOtherProgramsAreIgnored) {
  for (const char* other :
       {"/platoon/vehicle_x/position", "/platoon/vehicle_01/position", "/platoon/vehicle_-1/position",
        "/platoon/vehicle_1234567890/position", "/platoon/vehicle_1/positions", "/platoon/vehicle_1/inputs/",
        "/platoon/vehicle_1/inputs/01", "/platoon/vehicle_1/inputs/x", "/platoon/inputs/1", "/inputs/1",
        "/platoon/vehicle_1/outputs/1", "/chatter", "", "/platoon/progress"}) {
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
