#include "stochastic_platoon/run/scaling/merge.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <random>

#include "unit/monte_carlo.hpp"
#include "unit/run/scaling/shard_fixture.hpp"
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

std::string refusal(const std::vector<std::string>& folders) {
  try {
    merge(folders);
  } catch (const ConfigurationError& error) {
    return error.what();
  }
  return "";
}

std::vector<Moments> whole(const Configuration& configuration) {
  const RunOptions& run = configuration.run;
  return monte_carlo(configuration.model, {run.seed, run.followers, run.steps, 512}, run.realizations).moments.totals();
}

void expect_same_bits(const std::vector<Moments>& found, const std::vector<Moments>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t c = 0; c < found.size(); ++c) {
    ASSERT_EQ(found[c].count, expected[c].count);
    ASSERT_EQ(found[c].mean, expected[c].mean);
    ASSERT_EQ(found[c].squared_deviations, expected[c].squared_deviations);
    if (std::isnan(expected[c].fourth_deviations)) continue;
    ASSERT_EQ(found[c].cubed_deviations, expected[c].cubed_deviations);
    ASSERT_EQ(found[c].fourth_deviations, expected[c].fourth_deviations);
  }
}

TEST(Merge, OfAnyNumberOfShardsInAnyOrderGivesTheBitsOfOneRun) {
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

TEST(Merge, OfShardsWhoseErrorsAreNotNormalKeepsTheBitsOfAllFourMoments) {
  const TemporaryFolder folder;
  std::vector<std::string> folders;
  for (std::uint64_t i = 0; i < 5; ++i) {
    folders.push_back(folder / std::to_string(i));
    ShardRun run = paper_shard(folders.back(), i, 5);
    run.configuration.model.default_vehicle().link.loss = LossModel();
    run.configuration.model.default_vehicle().link.loss->probability = 0.2;
    compute_locked(run);
  }
  std::reverse(folders.begin(), folders.end());
  const MergedRun merged = merge(folders);
  ASSERT_FALSE(std::isnan(merged.result.moments.front().fourth_deviations));
  expect_same_bits(merged.result.moments, whole(merged.configuration));
}

TEST(Merge, NamesTheIndicesOfWhatIsMissing) {
  const TemporaryFolder folder;
  std::vector<std::string> folders = shards(folder, 13);
  for (const int i : {12, 9, 8, 7, 3}) folders.erase(folders.begin() + i);
  EXPECT_EQ(refusal(folders), "shards 3,7-9,12 of 13: missing: must be computed (sbatch --array=3,7-9,12)");
}

TEST(Merge, NamesAShardThatIsGivenTwice) {
  const TemporaryFolder folder;
  std::vector<std::string> folders = shards(folder, 3);
  folders.push_back(folders[1]);
  EXPECT_EQ(refusal(folders), folders[1] + ": holds shard 1/3, as does " + folders[1] + ": must be given once");
}

TEST(Merge, NamesAShardThatIsNotComplete) {
  const TemporaryFolder folder;
  const std::vector<std::string> folders = shards(folder, 3);
  Checkpoint shard = *read_checkpoint(folders[1]);
  const RealizationRange range = paper_shard("", 1, 3).range();
  EnsembleRun some(paper_platoon(), {1, 2, 3, 8}, {range.first, range.first + 10});
  some.work();
  shard.totals = some.release();
  write_checkpoint(folders[1], shard);
  EXPECT_EQ(refusal(folders), "2 errors:\n  shards 1 of 3: missing: must be computed (sbatch --array=1)\n  " +
                                  folders[1] + ": shard 1/3 is not complete: 10 of " + std::to_string(range.size()) +
                                  " realizations");
}

TEST(Merge, RefusesAShardThatHoldsMoreThanItsRange) {
  const TemporaryFolder folder;
  const std::vector<std::string> folders = shards(folder, 3);
  Checkpoint shard = *read_checkpoint(folders[1]);
  shard.totals.merge(read_checkpoint(folders[2])->totals);
  write_checkpoint(folders[1], shard);
  EXPECT_NE(refusal(folders).find("shard 1/3 is not complete"), std::string::npos);
}

// The difference that merge reports for a shard of another run.
std::string named_difference(const std::function<void(ShardRun&)>& change) {
  const TemporaryFolder folder;
  std::vector<std::string> folders = shards(folder, 3);
  std::filesystem::remove_all(folders[2]);
  ShardRun other = paper_shard(folders[2], 2, 3);
  change(other);
  compute_locked(other);
  const std::string said = refusal(folders), begin = folders[2] + ": belongs to another run than " + folders[0] + ": ";
  EXPECT_NE(said.find(begin), std::string::npos) << said;
  EXPECT_NE(said.find("shards 2 of 3: missing"), std::string::npos) << said;
  return said.substr(std::min(said.size(), said.find(begin) + begin.size()));
}

TEST(Merge, NamesInWhatShardsAreOfDifferentRuns) {
  EXPECT_EQ(named_difference([](ShardRun& run) { run.configuration.run.seed = 2; }), "seed is 1 there and 2 here");
  EXPECT_EQ(named_difference([](ShardRun& run) { run.configuration.run.followers = 3; }),
            "followers is 2 there and 3 here");
  EXPECT_EQ(named_difference([](ShardRun& run) { run.configuration.run.steps = 4; }), "steps is 3 there and 4 here");
  EXPECT_EQ(named_difference([](ShardRun& run) { run.configuration.run.realizations = 1001; }),
            "realizations is 1000 there and 1001 here");
  EXPECT_EQ(named_difference([](ShardRun& run) { run.shard.of = 4; }), "shards is 3 there and 4 here");
  EXPECT_EQ(named_difference([](ShardRun& run) { run.configuration.model.default_vehicle().noise_variance = 0.5; }),
            "noise_variance is 0.6 there and 0.5 here");
  EXPECT_EQ(named_difference([](ShardRun& run) { run.configuration.model.default_vehicle().link.delay = 1; }),
            "channel is null there and {\"delay\":1} here");
}

// A checkpoint from another version, or from a build whose closed loop has other bits.
TEST(Merge, NamesAnotherVersionAndAnotherMachinesBits) {
  for (const char* key : {"version", "realization"}) {
    const TemporaryFolder folder;
    const std::vector<std::string> folders = shards(folder, 3);
    Checkpoint shard = *read_checkpoint(folders[2]);
    shard.identity[key] = "other";
    write_checkpoint(folders[2], shard);
    EXPECT_NE(refusal(folders).find(folders[2] + ": belongs to another run than " + folders[0] + ": " + key),
              std::string::npos);
    EXPECT_NE(refusal({folders[2]}).find("is of a run that this machine would compute otherwise: " + std::string(key)),
              std::string::npos);
  }
}

TEST(Merge, NamesFoldersThatHoldNoShard) {
  const TemporaryFolder folder, run;
  std::vector<std::string> folders = shards(folder, 2);
  Checkpoint whole_run = *read_checkpoint(folders[0]);
  whole_run.shard = nullptr;
  write_checkpoint(run.path(), whole_run);
  folders.push_back(folder / "none");
  folders.push_back(run.path());
  EXPECT_EQ(refusal(folders), "2 errors:\n  " + (folder / "none") +
                                  ": holds no shard: must be the output of monte_carlo --shard\n  " + run.path() +
                                  ": holds a run of 496 realizations and no shard");
}

TEST(Merge, NamesTheFirstOfManyProblems) {
  std::vector<std::string> folders;
  for (int i = 0; i < 1000; ++i) folders.push_back("/nowhere/" + std::to_string(i));
  const std::string said = refusal(folders);
  EXPECT_NE(said.find("/nowhere/19: "), std::string::npos);
  EXPECT_EQ(said.find("/nowhere/20: "), std::string::npos);
  EXPECT_NE(said.find("and 980 more"), std::string::npos);
}

TEST(Merge, TakesNoShardThatWasChangedInAnyByte) {
  const TemporaryFolder folder;
  const std::vector<std::string> folders = shards(folder, 3);
  const std::string file = checkpoint_file(folders[1]), sound = content_of(file);
  ASSERT_GT(sound.size(), 500u);
  const auto expect_refused = [&](const std::string& bent, const std::string& how) {
    std::ofstream(file, std::ios::binary) << bent;
    EXPECT_EQ(refusal({folders[1]}).find(file + ": is not a checkpoint that can be read"), 0u) << how;
  };
  for (std::size_t place = 0; place < sound.size() && !HasFailure(); ++place) {
    std::string bent = sound;
    bent[place] = static_cast<char>(bent[place] ^ (1 << (place % 8)));
    expect_refused(bent, "bit flipped in byte " + std::to_string(place));
    expect_refused(sound.substr(0, place), "cut off at byte " + std::to_string(place));
  }
  expect_refused(sound + "x", "longer");
  EXPECT_NE(refusal(folders).find("shards 1 of 3: missing"), std::string::npos);
  std::ofstream(file, std::ios::binary) << sound;
  EXPECT_EQ(refusal(folders), "");
}

TEST(ArrayIndices, AreWrittenAsSlurmTakesThem) {
  EXPECT_EQ(array_indices({}), "");
  EXPECT_EQ(array_indices({0}), "0");
  EXPECT_EQ(array_indices({0, 1, 2, 5, 7, 8}), "0-2,5,7-8");
}

}  // namespace
}  // namespace platoon
