#include "stochastic_platoon/run/scaling/whole_run.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "unit/messages.hpp"
#include "unit/run/scaling/shard_fixture.hpp"
#include "unit/temporary_folder.hpp"

namespace platoon {
namespace {

// The folder of a run of hours may vanish, or its disk may be full, when all is computed.
TEST(WholeRun, KeepsItsResultsIfTheFolderIsGoneAtTheEnd) {
  const TemporaryFolder folder;
  const Configuration configuration = paper_shard(folder / "run", 0, 1).configuration;
  ShardSettings settings;
  settings.progress = [&](std::uint64_t done) {
    if (done == 1000) std::filesystem::remove_all(folder / "run");
  };
  const WholeRun run = compute_run(configuration, settings);
  EXPECT_TRUE(contains(run.unsaved, "/run/checkpoint.cbor.part: cannot be written: No such file or directory"));
  EXPECT_TRUE(run.result.complete);
  Configuration in_memory = configuration;
  in_memory.run.output.clear();
  const RunResult expected = compute_run(in_memory, {}).result;
  ASSERT_EQ(run.result.moments.size(), expected.moments.size());
  for (std::size_t c = 0; c < expected.moments.size(); ++c)
    EXPECT_EQ(run.result.moments[c].mean, expected.moments[c].mean);
  EXPECT_EQ(compute_run(configuration, {}).unsaved, "") << "the folder is made again";
}

TEST(ComputeShard, TellsThatItIsNotSaved) {
  const TemporaryFolder folder;
  const ShardRun shard = paper_shard(folder / "shard", 1, 3);
  ShardSettings settings;
  settings.progress = [&](std::uint64_t) { std::filesystem::remove_all(folder / "shard"); };
  const std::unique_ptr<FolderLock> lock = lock_output(shard.configuration.run);
  const ShardResult result = compute_shard(shard, settings);
  EXPECT_EQ(result.checkpoint.totals.count(), shard.range().size());
  EXPECT_TRUE(contains(result.unsaved, "cannot be written: No such file or directory"));
}

}  // namespace
}  // namespace platoon
