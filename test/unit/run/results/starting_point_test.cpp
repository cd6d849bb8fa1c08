#include <gtest/gtest.h>

#include <filesystem>
#include <numeric>

#include "stochastic_platoon/run/results/checkpoint.hpp"
#include "unit/run/results/checkpoint_fixture.hpp"

namespace platoon {
namespace {

using StartingPointTest = CheckpointTest;

TEST_F(StartingPointTest, IsAbsentInANewFolderWhichIsCreated) {
  EXPECT_FALSE(starting_point(configuration_));
  EXPECT_FALSE(starting_point(paper_run(folder_ / "a/new/one")));
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "a/new/one"));
}

TEST_F(StartingPointTest, IsTheCheckpointOfTheSameLaunch) {
  write(13);
  const std::optional<Checkpoint> start = starting_point(configuration_);
  ASSERT_TRUE(start);
  EXPECT_EQ(start->totals.count(), 13u);
}

TEST_F(StartingPointTest, IsTheCheckpointOfAnotherLaunchOnlyIfItIsResumed) {
  write(13);
  configuration_.run.launch_id = "another launch";
  const std::string before = content();
  EXPECT_EQ(rejection(),
            "output: " + folder_.path() +
                ": holds a run of 13 realizations: must be another folder (or resume:=true to continue that "
                "run)");
  EXPECT_EQ(content(), before);
  configuration_.run.resume = true;
  EXPECT_EQ(starting_point(configuration_)->totals.count(), 13u);
}

TEST_F(StartingPointTest, DistinguishesLaunchesWithoutAName) {
  configuration_.run.launch_id.clear();
  write(13);
  EXPECT_NE(rejection(), "");
}

TEST_F(StartingPointTest, NamesTheDifferencesFromAnotherConfiguration) {
  write(13);
  configuration_.run.resume = true;
  configuration_.run.seed = 2;
  configuration_.model.default_vehicle().position().noise_variance = 0.25;
  EXPECT_EQ(rejection(), "output: " + folder_.path() +
                             ": holds a run of another configuration: noise_variance is 0.6 there and 0.25 here, seed "
                             "is 1 there and 2 here");
}

TEST_F(StartingPointTest, NamesAKeyThatOnlyOneConfigurationHas) {
  configuration_.model.default_vehicle().position().link.delay = 1;
  write(13);
  configuration_.model.default_vehicle().position().link.delay = 0;
  EXPECT_TRUE(contains(rejection(), "channel is {\"delay\":1} there and null here"));
}

TEST_F(StartingPointTest, NamesTheValueThatDiffersWithinALongOne) {
  std::vector<double>& drive = configuration_.model.recorded_leader;
  drive.assign(500, 0.0);
  write(13);
  drive[300] = 12.5;
  EXPECT_TRUE(contains(rejection(), ": leader/positions/300 is 0.0 there and 12.5 here")) << rejection();
  std::iota(drive.begin(), drive.end(), 1.0);
  EXPECT_TRUE(contains(rejection(), "leader/positions/4 is 0.0 there and 5.0 here (and 495 more)")) << rejection();
  drive.resize(400);
  EXPECT_TRUE(contains(rejection(), "leader/positions is [0.0,0.0,")) << rejection();
}

TEST_F(StartingPointTest, RejectsAnotherConfigurationEvenOfTheSameLaunch) {
  write(13);
  configuration_.run.steps = 4;
  EXPECT_TRUE(contains(rejection(), "steps is 3 there and 4 here"));
  configuration_.run.steps = 3;
  configuration_.run.followers = 3;
  EXPECT_TRUE(contains(rejection(), "followers is 2 there and 3 here"));
  configuration_ = paper_run(folder_.path(), 2.4);
  EXPECT_TRUE(contains(rejection(), "time_headway is 3.2 there and 2.4 here"));
}

TEST_F(StartingPointTest, AllowsMoreRealizationsAndOtherBatchesThanBefore) {
  write(20);
  EXPECT_EQ(starting_point(configuration_)->totals.count(), 20u);
  configuration_.run.realizations = 1000;
  configuration_.run.batch = 7;
  configuration_.run.hosting = Hosting::one_process;
  EXPECT_EQ(starting_point(configuration_)->totals.count(), 20u);
}

TEST_F(StartingPointTest, RejectsFewerRealizationsThanThereAre) {
  write(20);
  configuration_.run.realizations = 19;
  EXPECT_EQ(rejection(), "realizations: 19: must be at least the 20 that " + folder_.path() + " holds already");
}

TEST_F(StartingPointTest, RejectsMissingRealizations) {
  Checkpoint gap = checkpoint(8);
  gap.totals.moments.add(BatchMoments(16, 4, kCells));
  write(gap);
  EXPECT_TRUE(contains(rejection(), "must hold realizations 0, 1, ... without a gap"));
}

TEST_F(StartingPointTest, RejectsAFolderThatCannotBeWritten) {
  const std::string file = folder_.file("file", "content");
  for (const std::string& path : {file, file + "/below"}) {
    configuration_.run.output = path;
    EXPECT_TRUE(begins_with(rejection(), "output: " + path + ": cannot be made: "));
    EXPECT_TRUE(contains(rejection(), ": must be a folder that can be written"));
  }
  EXPECT_EQ(content_of(file), "content");
}

TEST_F(StartingPointTest, RejectsADamagedCheckpointAndLeavesIt) {
  folder_.file("checkpoint.cbor", "damaged");
  EXPECT_TRUE(begins_with(rejection(), "output: " + file() + ": is not a checkpoint that can be read"));
  EXPECT_EQ(content(), "damaged");
}

TEST_F(StartingPointTest, RejectsResultsWithoutACheckpointAndLeavesThem) {
  for (const char* name : {"statistics.csv", "summary.json"}) {
    const std::string file = folder_.file(name, "of another run");
    for (const bool resume : {false, true}) {
      configuration_.run.resume = resume;
      EXPECT_EQ(rejection(), "output: " + folder_.path() +
                                 ": holds results already, which are never overwritten, and no checkpoint to continue "
                                 "from: must be another folder");
    }
    EXPECT_EQ(content_of(file), "of another run");
    std::filesystem::remove(file);
  }
}

TEST_F(StartingPointTest, RejectsAShard) {
  Checkpoint shard = checkpoint(13);
  shard.shard = {{"index", 0}};
  write(shard);
  EXPECT_EQ(rejection(), "output: " + folder_.path() + ": holds a shard of a run: must be another folder");
}

}  // namespace
}  // namespace platoon
