#include "stochastic_platoon/run/scaling/merge.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>

#include "unit/damage.hpp"
#include "unit/messages.hpp"
#include "unit/monte_carlo.hpp"
#include "unit/run/scaling/shard_fixture.hpp"
#include "unit/same_bits.hpp"
#include "unit/temporary_folder.hpp"

namespace platoon {
namespace {

// Computes all shards of the paper's run, each in its folder.
std::vector<std::string> shards(const TemporaryFolder& folder, std::uint64_t of) {
  std::vector<std::string> folders;
  for (std::uint64_t i = 0; i < of; ++i) {
    folders.push_back(folder / ("shard-" + std::to_string(i)));
    compute_locked(paper_shard(folders.back(), i, of));
  }
  return folders;
}

std::string rejection(const std::vector<std::string>& folders) {
  return message_of<ConfigurationError>([&folders] { merge(folders); });
}

std::vector<Moments> whole(const Configuration& configuration) {
  const RunOptions& run = configuration.run;
  return monte_carlo(configuration.model, {run.seed, run.followers, run.steps, 512}, run.realizations).moments.totals();
}

// Three shards of a run, each in its folder.
class MergeTest : public testing::Test {
protected:
  // Merges the shards after a change of one of their checkpoints.
  std::string rejection_after(std::size_t shard, const std::function<void(Checkpoint&)>& change) const {
    Checkpoint checkpoint = *read_checkpoint(folders_[shard]);
    change(checkpoint);
    write_checkpoint(folders_[shard], checkpoint);
    return rejection(folders_);
  }

  TemporaryFolder folder_;
  std::vector<std::string> folders_ = shards(folder_, 3);
};

TEST(Merge, OfAnyNumberOfShardsInAnyOrderHasTheBitsOfOneRun) {
  std::mt19937 generator(1);
  for (const std::uint64_t of : {1, 2, 3, 7, 13, 32}) {
    const TemporaryFolder folder;
    std::vector<std::string> folders = shards(folder, of);
    std::shuffle(folders.begin(), folders.end(), generator);
    const MergedRun merged = merge(folders);
    EXPECT_TRUE(merged.result.complete);
    EXPECT_EQ(merged.result.realizations, 1000u);
    EXPECT_EQ(merged.configuration.run.realizations, 1000u);
    EXPECT_EQ(merged.result.tally.positions_received, 1000u * 3 * 4);
    expect_same_bits(merged.result.moments, whole(merged.configuration));
  }
}

TEST(Merge, OfALossyRunHasTheBitsOfAllFourMoments) {
  const TemporaryFolder folder;
  std::vector<std::string> folders;
  for (std::uint64_t i = 0; i < 5; ++i) {
    folders.push_back(folder / std::to_string(i));
    ShardRun run = paper_shard(folders.back(), i, 5);
    run.configuration.model.default_vehicle().position().link.loss = LossModel();
    run.configuration.model.default_vehicle().position().link.loss->probability = 0.2;
    compute_locked(run);
  }
  std::reverse(folders.begin(), folders.end());
  const MergedRun merged = merge(folders);
  ASSERT_FALSE(std::isnan(merged.result.moments.front().fourth_deviations));
  expect_same_bits(merged.result.moments, whole(merged.configuration));
}

TEST(Merge, NamesTheIndicesOfMissingShards) {
  const TemporaryFolder folder;
  std::vector<std::string> folders = shards(folder, 13);
  for (const int i : {12, 9, 8, 7, 3}) folders.erase(folders.begin() + i);
  EXPECT_EQ(rejection(folders), "shards 3,7-9,12 of 13: missing: must be computed (sbatch --array=3,7-9,12)");
}

TEST_F(MergeTest, NamesAShardThatIsGivenTwice) {
  folders_.push_back(folders_[1]);
  EXPECT_EQ(rejection(folders_), folders_[1] + ": holds shard 1/3, as does " + folders_[1] + ": must be given once");
}

TEST_F(MergeTest, NamesAShardThatIsNotComplete) {
  const RealizationRange range = paper_shard("", 1, 3).range();
  EXPECT_EQ(rejection_after(1,
                            [&range](Checkpoint& shard) {
                              EnsembleRun some(paper_platoon(), {1, 2, 3, 8}, {range.first, range.first + 10});
                              some.work();
                              shard.totals = some.release();
                            }),
            "2 errors:\n  shards 1 of 3: missing: must be computed (sbatch --array=1)\n  " + folders_[1] +
                ": shard 1/3 is not complete: 10 of " + std::to_string(range.size()) + " realizations");
}

TEST_F(MergeTest, RejectsAShardThatHoldsMoreThanItsRange) {
  EXPECT_TRUE(contains(
      rejection_after(1, [this](Checkpoint& shard) { shard.totals.merge(read_checkpoint(folders_[2])->totals); }),
      "shard 1/3 is not complete"));
}

TEST_F(MergeTest, NamesTheDifferencesOfAnotherRun) {
  struct Case {
    std::function<void(ShardRun&)> change;
    std::string difference;
  };
  for (const auto& [change, difference] : {
           Case{[](ShardRun& run) { run.configuration.run.seed = 2; }, "seed is 1 there and 2 here"},
           Case{[](ShardRun& run) { run.configuration.run.followers = 3; }, "followers is 2 there and 3 here"},
           Case{[](ShardRun& run) { run.configuration.run.steps = 4; }, "steps is 3 there and 4 here"},
           Case{[](ShardRun& run) { run.configuration.run.realizations = 1001; },
                "realizations is 1000 there and 1001 here"},
           Case{[](ShardRun& run) { run.shard.of = 4; }, "shards is 3 there and 4 here"},
           Case{[](ShardRun& run) { run.configuration.model.default_vehicle().position().noise_variance = 0.5; },
                "noise_variance is 0.6 there and 0.5 here"},
           Case{[](ShardRun& run) { run.configuration.model.default_vehicle().position().link.delay = 1; },
                "channel is null there and {\"delay\":1} here"},
       }) {
    std::filesystem::remove_all(folders_[2]);
    ShardRun other = paper_shard(folders_[2], 2, 3);
    change(other);
    compute_locked(other);
    EXPECT_TRUE(contains(rejection(folders_), "shards 2 of 3: missing"));
    EXPECT_TRUE(contains(rejection(folders_) + "\n",
                         folders_[2] + ": belongs to another run than " + folders_[0] + ": " + difference + "\n"));
  }
}

// A checkpoint from another version, or from a build whose closed loop has other bits.
TEST_F(MergeTest, NamesAnotherVersionAndTheBitsOfAnotherMachine) {
  const nlohmann::json identity = read_checkpoint(folders_[2])->identity;
  for (const std::string key : {"version", "realization"}) {
    EXPECT_TRUE(contains(rejection_after(2,
                                         [&](Checkpoint& shard) {
                                           shard.identity = identity;
                                           shard.identity[key] = "other";
                                         }),
                         folders_[2] + ": belongs to another run than " + folders_[0] + ": " + key));
    EXPECT_TRUE(contains(rejection({folders_[2]}), "is of a run that this machine would compute otherwise: " + key));
  }
}

TEST(Merge, NamesFoldersWithoutAShard) {
  const TemporaryFolder folder, run;
  std::vector<std::string> folders = shards(folder, 2);
  Checkpoint whole_run = *read_checkpoint(folders[0]);
  whole_run.shard = nullptr;
  write_checkpoint(run.path(), whole_run);
  folders.push_back(folder / "none");
  folders.push_back(run.path());
  EXPECT_EQ(rejection(folders), "2 errors:\n  " + (folder / "none") +
                                    ": holds no shard: must be the output of monte_carlo --shard or rare --shard\n  " +
                                    run.path() + ": holds a run of 496 realizations and no shard");
}

TEST(Merge, NamesTheFirstOfManyProblems) {
  std::vector<std::string> folders;
  for (int i = 0; i < 1000; ++i) folders.push_back("/nowhere/" + std::to_string(i));
  const std::string error = rejection(folders);
  EXPECT_TRUE(contains(error, "/nowhere/19: "));
  EXPECT_FALSE(contains(error, "/nowhere/20: "));
  EXPECT_TRUE(contains(error, "and 980 more"));
}

// checkpoint_test damages every byte.
TEST_F(MergeTest, NamesADamagedShard) {
  const std::string file = checkpoint_file(folders_[1]), sound = content_of(file);
  std::ofstream(file, std::ios::binary) << with_flipped_bit(sound, 4 * sound.size());
  EXPECT_TRUE(begins_with(rejection({folders_[1]}), file + ": is not a checkpoint that can be read"));
  EXPECT_TRUE(contains(rejection(folders_), "shards 1 of 3: missing"));
  std::ofstream(file, std::ios::binary) << sound;
  EXPECT_EQ(rejection(folders_), "");
}

TEST(ArrayIndices, AreWrittenAsSlurmExpectsThem) {
  EXPECT_EQ(array_indices({}), "");
  EXPECT_EQ(array_indices({0}), "0");
  EXPECT_EQ(array_indices({0, 1, 2, 5, 7, 8}), "0-2,5,7-8");
}

}  // namespace
}  // namespace platoon
