#include "stochastic_platoon/run/configuration/launch_arguments.hpp"

#include <gtest/gtest.h>

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
