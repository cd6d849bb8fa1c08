#include "stochastic_platoon/run/configuration/launch_arguments.hpp"

#include <gtest/gtest.h>

#include "stochastic_platoon/run/configuration/configuration_error.hpp"
#include "unit/messages.hpp"
#include "unit/temporary_folder.hpp"

namespace platoon {
namespace {

using Words = std::vector<std::string>;

const std::string kFolder = PLATOON_SOURCE_DIR "/launch";
const std::string kHint = " (roslaunch --ros-args lists the arguments)";

Words problems(Words words) {
  Words line{"/usr/bin/python3", "/usr/bin/roslaunch"};
  line.insert(line.end(), words.begin(), words.end());
  return undeclared_arguments(line, kFolder);
}

TEST(LaunchArguments, NameAMisspeltArgumentAndTheNearestOne) {
  EXPECT_EQ(problems({"stochastic_platoon", "platoon.launch", "headways:=2.4"}),
            Words{"headways: unknown argument of platoon.launch: did you mean headway?" + kHint});
  EXPECT_EQ(problems({kFolder + "/platoon.launch", "folowers:=3", "seed:=2", "colour:=red"}),
            (Words{"folowers: unknown argument of platoon.launch: did you mean followers?" + kHint,
                   "colour: unknown argument of platoon.launch" + kHint}));
}

TEST(LaunchArguments, MayBeAllDeclaredOnesAndHaveEmptyValues) {
  EXPECT_EQ(
      problems({"stochastic_platoon", "platoon.launch", "headway:=", "record:=/tmp/a b.bag", "hosting:=one_process"}),
      Words{});
  EXPECT_EQ(problems({"-p", "11312", "--screen", "stochastic_platoon", "replay.launch", "bag:=x.bag", "drive:=leader",
                      "__name:=x"}),
            Words{});
}

TEST(LaunchArguments, OfAnIncludedFileAreAcceptedIfTheIncludePassesAll) {
  EXPECT_EQ(problems({"stochastic_platoon", "live.launch", "rate:=20", "burn_in:=100", "hosting:=one_process"}),
            Words{});
  EXPECT_EQ(problems({"stochastic_platoon", "live.launch", "rates:=20"}),
            Words{"rates: unknown argument of live.launch: did you mean rate?" + kHint});
}

TEST(LaunchArguments, InCommentsAreIgnored) {
  const TemporaryFolder folder;
  const std::string mine =
      folder.file("mine.launch",
                  "<launch>\n<!-- <arg name=\"old\"/> -->\n<arg name=\"speed\" default=\"1\"/>"
                  "\n<include file=\"$(find stochastic_platoon)/launch/platoon.launch\"/></launch>\n");
  EXPECT_EQ(problems({mine, "speed:=2"}), Words{});
  EXPECT_EQ(problems({mine, "old:=2"}), Words{"old: unknown argument of mine.launch" + kHint});
  EXPECT_EQ(problems({mine, "headway:=2.4"}).size(), 1u) << "it does not pass it on";
}

TEST(LaunchArguments, HaveAPortThatExists) {
  for (const char* port : {"", "0", "1", "8080", "65535"})
    EXPECT_NO_THROW(require_port("dashboard_port", port)) << port;
  for (const std::string port : {"99999", "65536", "-1", "http", "80.5"}) {
    const std::string problem = message_of<ConfigurationError>([&] { require_port("dashboard_port", port); });
    EXPECT_TRUE(contains(problem, "dashboard_port: " + port + ": must be a whole number from 0 to 65535"));
  }
}

TEST(LaunchArguments, OfAReplayHaveAnEffect) {
  const Words none;
  EXPECT_EQ(ineffective_arguments({}), none);
  EXPECT_EQ(ineffective_arguments({{"replay_rate", "0"}, {"start", "0"}, {"pause", "false"}, {"patience", "60"}}),
            none);
  EXPECT_EQ(ineffective_arguments({{"replay_rate", "2"}, {"start", "5"}, {"pause", "true"}, {"stay", "1"}}), none);
  EXPECT_EQ(ineffective_arguments({{"drive", "leader"}, {"replay_rate", "2"}, {"external", "1,3"}}), none);
  EXPECT_EQ(ineffective_arguments({{"drive", "vehicle_3"}, {"patience", "20"}, {"external", "3"}}), none);
  EXPECT_EQ(ineffective_arguments({{"replay_rate", "-1"}, {"start", "x"}, {"patience", "5"}, {"external", "2"}}),
            (Words{"rate: -1: must be a finite number >= 0", "start: x: must be a finite number >= 0",
                   "patience: given: must be with drive:=vehicle_N",
                   "external: given: must be with drive:=leader or drive:=vehicle_N"}));
  EXPECT_EQ(ineffective_arguments({{"drive", "vehicle_3"}, {"patience", "0"}}),
            Words{"patience: 0: must be a finite number > 0"});
  EXPECT_EQ(ineffective_arguments({{"start", "5"}}),
            Words{"start: given: must be with a rate above 0, as otherwise all passes as fast as possible"});
  EXPECT_EQ(ineffective_arguments({{"drive", "leader"}, {"replay_rate", "2"}, {"start", "5"}, {"pause", "True"}}),
            (Words{"start: given: must be without drive:=leader", "pause: given: must be without drive:=leader"}));
  EXPECT_EQ(ineffective_arguments({{"drive", "vehicle_3"},
                                   {"replay_rate", "2"},
                                   {"start", "5"},
                                   {"pause", "1"},
                                   {"dashboard", "true"},
                                   {"stay", "true"},
                                   {"output", "/tmp/run"},
                                   {"external", "2,3"}}),
            (Words{"start: given: must be without drive:=vehicle_3", "pause: given: must be without drive:=vehicle_3",
                   "rate: given: must be without drive:=vehicle_3, as the vehicle is driven as fast as it answers",
                   "dashboard: given: must be without drive:=vehicle_3, which ends with a verdict",
                   "stay: given: must be without drive:=vehicle_3, which ends with a verdict",
                   "output: given: must be without drive:=vehicle_3, which has no results but a verdict",
                   "external: 2,3: must be 3, the replayed vehicle, or empty"}));
}

TEST(LaunchArguments, SelectTheMasterBeforeTheEnvironmentAndTheDefault) {
  const Words file{"roslaunch", "stochastic_platoon", "platoon.launch"};
  for (const Words& port : {Words{"-p", "11312"}, Words{"-p11312"}, Words{"--port", "11312"}, Words{"--port=11312"}}) {
    Words line = file;
    line.insert(line.begin() + 1, port.begin(), port.end());
    EXPECT_EQ(master_address(line, "http://other:1"), "http://localhost:11312");
  }
  EXPECT_EQ(master_address(file, "http://other:1"), "http://other:1");
  EXPECT_EQ(master_address(file, nullptr), "http://localhost:11311");
}

TEST(LaunchArguments, OfOtherPackagesAndProgramsAreNotChecked) {
  EXPECT_EQ(problems({"other_package", "theirs.launch", "headways:=2.4"}), Words{});
  EXPECT_EQ(undeclared_arguments({"configure", "--model", "x.launch", "headways:=2"}, kFolder), Words{});
  EXPECT_EQ(undeclared_arguments({}, kFolder), Words{});
}

}  // namespace
}  // namespace platoon
