#include "stochastic_platoon/run/scaling/shard_run.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "stochastic_platoon/math/simulation/ensemble_run.hpp"
#include "unit/damage.hpp"
#include "unit/messages.hpp"
#include "unit/run/scaling/shard_fixture.hpp"
#include "unit/same_bits.hpp"
#include "unit/temporary_folder.hpp"

namespace platoon {
namespace {

std::string rejection(const ShardRun& run) {
  return message_of<ConfigurationError>([&run] { compute_shard(run, {}); });
}

std::string rejection(const std::string& shard, std::uint64_t realizations) {
  return message_of<ConfigurationError>([&] { parse_shard(shard, realizations); });
}

TEST(ParseShard, ReadsIndexAndNumber) {
  EXPECT_EQ(parse_shard("0/1", 1).of, 1u);
  EXPECT_EQ(parse_shard("63/64", 1000).index, 63u);
}

TEST(ParseShard, RejectsEverythingElse) {
  for (const char* text : {"64/64", "-1/64", "0/0", "1", "", "a/b", "1/2/3", "1/2x", "0/1001", "1.5/2"}) {
    EXPECT_EQ(rejection(text, 1000),
              "shard: " + std::string(text) +
                  ": must be I/N, I from 0 to N - 1, N at most the 1000 realizations and 1000000");
  }
  EXPECT_EQ(rejection("0/1000001", kMostShards), "shard: 0/1000001: must be I/N, I from 0 to N - 1, N at most 1000000");
  EXPECT_NE(rejection("0/1000001", 2000000), "");
}

TEST(ShardRun, IsReadBackFromItsRecord) {
  const ShardRun run = paper_shard("/somewhere", 3, 7);
  const ShardRun read = shard_run_of(nlohmann::json::parse(to_json(run).dump()));
  EXPECT_EQ(read.shard.index, 3u);
  EXPECT_EQ(read.shard.of, 7u);
  EXPECT_EQ(read.configuration.run.realizations, 1000u);
  EXPECT_EQ(read.configuration.run.hosting, Hosting::monte_carlo);
  EXPECT_EQ(statistics_identity(read.configuration), statistics_identity(run.configuration));
}

TEST(ShardRun, RejectsAnInvalidRecord) {
  nlohmann::json record = to_json(paper_shard("/somewhere", 3, 7));
  record["index"] = 7;
  EXPECT_THROW(shard_run_of(record), std::runtime_error);
  record["index"] = "three";
  EXPECT_THROW(shard_run_of(record), std::runtime_error);
  EXPECT_THROW(shard_run_of(nlohmann::json::object()), std::runtime_error);
  EXPECT_THROW(shard_run_of(5), std::runtime_error);
  record = to_json(paper_shard("/somewhere", 3, 7));
  record["configuration"]["version"] = kFirstReadableVersion;  // of recordings, not of checkpoints
  EXPECT_THROW(shard_run_of(record), std::runtime_error);
}

TEST(ComputeShard, WritesItsRealizationsOnce) {
  const TemporaryFolder folder;
  const ShardRun run = paper_shard(folder.path(), 2, 7);
  EXPECT_EQ(compute_shard(run, {}).computed, run.range().size());
  const std::optional<Checkpoint> left = read_checkpoint(folder.path());
  EXPECT_EQ(left->totals.count(), run.range().size());
  EXPECT_TRUE(left->totals.moments.missing(run.range()).empty());
  const std::string before = content_of(checkpoint_file(folder.path()));
  EXPECT_EQ(compute_shard(run, {}).computed, 0u);
  EXPECT_EQ(content_of(checkpoint_file(folder.path())), before);
}

// The checkpoint after a kill: some batches, not all of them consecutive.
Checkpoint broken_off(const ShardRun& run) {
  Checkpoint checkpoint{statistics_identity(run.configuration),
                        run.configuration.run.launch_id,
                        {},
                        EnsembleTotals(cells_of(run.configuration))};
  checkpoint.shard = to_json(run);
  const RunOptions& options = run.configuration.run;
  const RealizationRange range = run.range();
  for (const RealizationRange& part :
       {RealizationRange{range.first, range.first + 24}, RealizationRange{range.first + 32, range.first + 40}}) {
    EnsembleRun some(run.configuration.model, ensemble_of(options), part);
    some.work();
    checkpoint.totals.merge(some.release());
  }
  return checkpoint;
}

TEST(ComputeShard, ContinuesFromItsCheckpointToTheSameBits) {
  const TemporaryFolder whole, killed;
  compute_shard(paper_shard(whole.path(), 2, 7), {});
  const ShardRun run = paper_shard(killed.path(), 2, 7);
  write_checkpoint(killed.path(), broken_off(run));
  EXPECT_EQ(compute_shard(run, {}).computed, run.range().size() - 32);
  expect_same_bits(read_checkpoint(killed.path())->totals.moments, read_checkpoint(whole.path())->totals.moments);
}

TEST(ComputeShard, StartsAnewWithAWarningIfItsCheckpointIsDamaged) {
  const TemporaryFolder folder;
  const ShardRun run = paper_shard(folder.path(), 2, 7);
  compute_shard(run, {});
  const std::string sound = content_of(checkpoint_file(folder.path()));
  folder.file("checkpoint.cbor", with_flipped_bit(sound, 4 * sound.size()));
  std::string warnings;
  ShardSettings settings;
  settings.warn = [&warnings](const std::string& text) { warnings += text; };
  EXPECT_EQ(compute_shard(run, settings).computed, run.range().size());
  EXPECT_TRUE(contains(warnings, "its digest is not that of its content: the shard begins anew"));
  EXPECT_EQ(read_checkpoint(folder.path())->totals.count(), run.range().size());
}

TEST(ComputeShard, RejectsTheFolderOfAnotherShardAndOfAnotherRun) {
  const TemporaryFolder folder;
  ShardRun run = paper_shard(folder.path(), 2, 7);
  compute_shard(run, {});
  run.shard.index = 3;
  EXPECT_EQ(rejection(run), "output: " + folder.path() +
                                ": holds shard 2/7 of 1000 realizations, and this is shard 3/7 of 1000: must be "
                                "another folder");
  run.shard.index = 2;
  run.configuration.run.realizations = 1001;
  EXPECT_TRUE(contains(rejection(run), "of 1000 realizations, and this is shard 2/7 of 1001"));
  run.configuration.run.realizations = 1000;
  run.configuration.run.seed = 2;
  EXPECT_EQ(rejection(run), "output: " + folder.path() + ": holds a shard of another run: seed is 1 there and 2 here");
}

TEST(ComputeShard, RejectsTheFolderOfAWholeRunAndOfResults) {
  const TemporaryFolder run_folder, results;
  const ShardRun run = paper_shard(run_folder.path(), 0, 7);
  Checkpoint whole = broken_off(run);
  whole.shard = nullptr;
  write_checkpoint(run_folder.path(), whole);
  EXPECT_EQ(rejection(run),
            "output: " + run_folder.path() + ": holds a run of 32 realizations and no shard: must be another folder");
  results.file("statistics.csv", "of another run");
  EXPECT_TRUE(
      contains(rejection(paper_shard(results.path(), 0, 7)), "holds results already, which are never overwritten"));
}

}  // namespace
}  // namespace platoon
