#include "stochastic_platoon/run/results/checkpoint.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <stdexcept>

#include "stochastic_platoon/math/noise/white_noise.hpp"
#include "unit/paper_run.hpp"
#include "unit/same_gaps.hpp"
#include "unit/temporary_folder.hpp"

namespace platoon {
namespace {

constexpr std::size_t kCells = 6;

MomentTable table(std::uint64_t realizations) {
  MomentTable result(kCells);
  BatchMoments batch(0, realizations, kCells);
  std::vector<double> values(realizations);
  for (std::size_t c = 0; c < kCells; ++c) {
    WhiteNoise(1).fill({static_cast<std::uint32_t>(c), 0}, 0, realizations, values.data());
    batch.set(c, values.data());
  }
  result.add(batch);
  return result;
}

Checkpoint checkpoint_of(const Configuration& configuration, std::uint64_t realizations) {
  return {statistics_identity(configuration),
          configuration.run.launch_id,
          {1234, 5, 6.75, 8901234567890123456u},
          EnsembleTotals(table(realizations))};
}

bool same_bits(const std::vector<double>& left, const std::vector<double>& right) {
  return left.size() == right.size() && std::memcmp(left.data(), right.data(), left.size() * sizeof(double)) == 0;
}

void expect_same_blocks(const MomentTable& found, const MomentTable& expected) {
  EXPECT_EQ(found.cells(), expected.cells());
  ASSERT_EQ(found.blocks().size(), expected.blocks().size());
  auto other = expected.blocks().begin();
  for (const auto& entry : found.blocks()) {
    EXPECT_EQ(entry.first, other->first);
    EXPECT_EQ(entry.second.range.first, other->second.range.first);
    EXPECT_EQ(entry.second.range.level, other->second.range.level);
    EXPECT_TRUE(same_bits(entry.second.mean, other->second.mean));
    EXPECT_TRUE(same_bits(entry.second.squared_deviations, other->second.squared_deviations));
    ++other;
  }
}

// The message with which starting_point rejects the folder; empty if it does not.
std::string refusal(const Configuration& configuration) {
  try {
    starting_point(configuration);
  } catch (const ConfigurationError& error) {
    EXPECT_EQ(error.problems().size(), 1u);
    return error.what();
  }
  return "";
}

TEST(Checkpoint, ComesBackToTheBit) {
  const TemporaryFolder folder;
  const Checkpoint written = checkpoint_of(paper_run(folder.path()), 13);
  write_checkpoint(folder.path(), written);
  EXPECT_EQ(folder.entries(), std::vector<std::string>{"checkpoint.cbor"});
  const std::optional<Checkpoint> read = read_checkpoint(folder.path());
  ASSERT_TRUE(read);
  EXPECT_EQ(read->identity, written.identity);
  EXPECT_EQ(read->launch_id, "this launch");
  EXPECT_EQ(read->tally.positions_received, 1234u);
  EXPECT_EQ(read->tally.attempts, 5u);
  EXPECT_EQ(read->tally.wall_seconds, 6.75);
  EXPECT_EQ(read->tally.platoon_time, 8901234567890123456u);
  expect_same_blocks(read->totals.moments, written.totals.moments);
}

TEST(Checkpoint, OfAveragesOverTimeComesBackToTheBit) {
  const TemporaryFolder folder;
  Configuration configuration = paper_run(folder.path());
  configuration.run.steps = 0;
  configuration.run.burn_in = 200;
  write_checkpoint(folder.path(), {statistics_identity(configuration),
                                   "this launch",
                                   {},
                                   {},
                                   {Moments{3, 0.1, 1.0 / 3.0}, Moments{4, -0.0, 1e-300}}});
  const std::optional<Checkpoint> read = starting_point(configuration);
  ASSERT_TRUE(read);
  ASSERT_EQ(read->time_averages.size(), 2u);
  EXPECT_EQ(read->time_averages[0].count, 3u);
  EXPECT_EQ(read->time_averages[0].squared_deviations, 1.0 / 3.0);
  EXPECT_TRUE(std::signbit(read->time_averages[1].mean));
  configuration.run.burn_in = 100;
  EXPECT_NE(refusal(configuration).find("burn_in is 200 there and 100 here"), std::string::npos);
  configuration.run.launch_id = "another launch";
  EXPECT_NE(refusal(configuration).find("holds a run of averages over 3 steps"), std::string::npos);
}

TEST(Checkpoint, KeepsTheSmallestGaps) {
  const TemporaryFolder folder;
  GapTable gaps({2, 0.1, 1.5});
  gaps.merge(1, {{-1.0 / 3.0, 99, 7}, 3, 4, {{-4, 1}, {12, 5}}});
  gaps.merge(2, {{0.1, 5, 0}, 0, 2, {{1, 6}}});
  Checkpoint written = checkpoint_of(paper_run(folder.path()), 6);
  written.totals.gaps = gaps;
  write_checkpoint(folder.path(), written);
  expect_same_gaps(read_checkpoint(folder.path())->totals.gaps, gaps);
}

TEST(Checkpoint, KeepsTheBitsOfEveryDouble) {
  using Limits = std::numeric_limits<double>;
  const TemporaryFolder folder;
  const std::vector<double> values = {-0.0,  0.1,           1.0 / 3.0,          Limits::denorm_min(),
                                      1e300, Limits::max(), -Limits::epsilon(), 0.5,
                                      1e-45, 16777217.0,    Limits::infinity(), Limits::quiet_NaN()};
  MomentTable unusual(values.size());
  unusual.add(MomentBlock{{3, 0}, values, values});
  unusual.add(MomentBlock{{std::uint64_t{1} << 45, 45}, values, values});
  write_checkpoint(folder.path(), {{}, "", {}, EnsembleTotals(unusual), {}});
  expect_same_blocks(read_checkpoint(folder.path())->totals.moments, unusual);
}

// After any damage to the latest checkpoint, the reader returns the one before it, to the bit, or none.
void expect_never_wrong(const TemporaryFolder& folder, const std::string& bent, const std::string& how) {
  folder.file("checkpoint.cbor", bent);
  const std::optional<Checkpoint> read = read_checkpoint(folder.path());
  ASSERT_TRUE(read) << how;
  EXPECT_EQ(read->totals.count(), 8u) << how;
  EXPECT_NE(read->damage, "") << how;
  EXPECT_EQ(read->launch_id, "this launch") << how;
}

TEST(Checkpoint, ThatIsDamagedAnywhereIsRecognizedAndTheOneBeforeItUsed) {
  const TemporaryFolder folder;
  write_checkpoint(folder.path(), checkpoint_of(paper_run(folder.path()), 8));
  write_checkpoint(folder.path(), checkpoint_of(paper_run(folder.path()), 13));
  EXPECT_EQ(read_checkpoint(folder.path())->totals.count(), 13u);
  EXPECT_EQ(read_checkpoint(folder.path())->damage, "");
  const std::string sound = content_of(checkpoint_file(folder.path()));
  for (std::size_t place = 0; place < sound.size() && !HasFailure(); ++place) {
    std::string bent = sound;
    bent[place] = static_cast<char>(bent[place] ^ (1 << (place % 8)));
    expect_never_wrong(folder, bent, "bit flipped in byte " + std::to_string(place));
    expect_never_wrong(folder, sound.substr(0, place), "cut off at byte " + std::to_string(place));
  }
  for (std::size_t place = 0; place + 64 <= sound.size(); place += 64) {
    std::string bent = sound;
    bent.replace(place, 64, 64, '\0');
    expect_never_wrong(folder, bent, "zeros from byte " + std::to_string(place));
  }
  expect_never_wrong(folder, sound + "x", "longer");
}

TEST(Checkpoint, ThatIsDamagedWithNoneBeforeItIsRefused) {
  const TemporaryFolder folder;
  const Configuration configuration = paper_run(folder.path());
  write_checkpoint(folder.path(), checkpoint_of(configuration, 8));
  std::string bent = content_of(checkpoint_file(folder.path()));
  bent.back() = static_cast<char>(bent.back() ^ 1);
  folder.file("checkpoint.cbor", bent);
  EXPECT_NE(refusal(configuration).find("its digest is not that of its content"), std::string::npos);
}

TEST(Checkpoint, OfBeforeIsReadWhereWritingTheLatestWasInterrupted) {
  const TemporaryFolder folder;
  write_checkpoint(folder.path(), checkpoint_of(paper_run(folder.path()), 8));
  std::filesystem::rename(checkpoint_file(folder.path()), previous_checkpoint_file(folder.path()));
  ASSERT_TRUE(read_checkpoint(folder.path()));
  EXPECT_EQ(read_checkpoint(folder.path())->totals.count(), 8u);
}

TEST(Checkpoint, WithAGapIsRefused) {
  const TemporaryFolder folder;
  Configuration configuration = paper_run(folder.path());
  Checkpoint gap = checkpoint_of(configuration, 8);
  BatchMoments later(16, 4, kCells);
  gap.totals.moments.add(later);
  write_checkpoint(folder.path(), gap);
  EXPECT_NE(refusal(configuration).find("must hold realizations 0, 1, ... without a gap"), std::string::npos);
}

TEST(Checkpoint, GoesOnAsIfThereHadBeenNoStop) {
  const TemporaryFolder folder;
  BatchMoments rest(13, 7, kCells);
  const std::vector<double> values = {1.0, 2.5, -3.0, 0.1, 0.2, 0.3, 7.0};
  for (std::size_t c = 0; c < kCells; ++c) rest.set(c, values.data());
  MomentTable undisturbed = table(13);
  undisturbed.add(rest);
  write_checkpoint(folder.path(), checkpoint_of(paper_run(folder.path()), 13));
  MomentTable resumed = read_checkpoint(folder.path())->totals.moments;
  resumed.add(rest);
  expect_same_blocks(resumed, undisturbed);
}

TEST(Checkpoint, IsNoneWhereThereIsNoFile) {
  const TemporaryFolder folder;
  EXPECT_FALSE(read_checkpoint(folder.path()));
  EXPECT_FALSE(read_checkpoint(folder / "none"));
}

TEST(Checkpoint, ThatIsDamagedIsNamed) {
  const TemporaryFolder folder;
  write_checkpoint(folder.path(), checkpoint_of(paper_run(folder.path()), 13));
  const std::string whole = content_of(checkpoint_file(folder.path()));
  for (const std::string& damaged :
       {std::string(), std::string("hello"), whole.substr(0, whole.size() / 2), whole.substr(1), whole + "x"}) {
    folder.file("checkpoint.cbor", damaged);
    try {
      read_checkpoint(folder.path());
      ADD_FAILURE() << "read " << damaged.size() << " bytes";
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(
          std::string(error.what()).find(checkpoint_file(folder.path()) + ": is not a checkpoint that can be read"),
          0u);
    }
  }
}

TEST(Checkpoint, OfAnotherFormatIsNamed) {
  const TemporaryFolder folder;
  const Configuration configuration = paper_run(folder.path());
  write_checkpoint(folder.path(), checkpoint_of(configuration, 13));
  std::string other = content_of(checkpoint_file(folder.path()));
  other.replace(other.find("checkpoint 3"), 12, "checkpoint 1");
  folder.file("checkpoint.cbor", other);
  EXPECT_NE(refusal(configuration).find("it does not begin with \"stochastic_platoon checkpoint 3\""),
            std::string::npos);
}

// An existing file that cannot be opened must not be overwritten. (A link to itself, because root can read a file
// without permissions.)
TEST(Checkpoint, ThatCannotBeOpenedIsNotTakenForNone) {
  const TemporaryFolder folder;
  std::filesystem::create_symlink("checkpoint.cbor", checkpoint_file(folder.path()));
  EXPECT_THROW(read_checkpoint(folder.path()), std::runtime_error);
  EXPECT_NE(refusal(paper_run(folder.path())), "");
}

TEST(StartingPoint, IsNoneInAFreshFolderWhichItMakes) {
  const TemporaryFolder folder;
  EXPECT_FALSE(starting_point(paper_run(folder.path())));
  EXPECT_FALSE(starting_point(paper_run(folder / "a/new/one")));
  EXPECT_TRUE(std::filesystem::is_empty(folder / "a/new/one"));
}

TEST(StartingPoint, IsTheCheckpointOfTheSameLaunch) {
  const TemporaryFolder folder;
  const Configuration configuration = paper_run(folder.path());
  write_checkpoint(folder.path(), checkpoint_of(configuration, 13));
  const std::optional<Checkpoint> start = starting_point(configuration);
  ASSERT_TRUE(start);
  EXPECT_EQ(start->totals.count(), 13u);
}

TEST(StartingPoint, IsTheCheckpointOfAnotherLaunchOnlyWhenItIsResumed) {
  const TemporaryFolder folder;
  Configuration configuration = paper_run(folder.path());
  write_checkpoint(folder.path(), checkpoint_of(configuration, 13));
  configuration.run.launch_id = "another launch";
  const std::string before = content_of(checkpoint_file(folder.path()));
  EXPECT_EQ(refusal(configuration), "output: " + folder.path() +
                                        ": holds a run of 13 realizations: must be another folder (or "
                                        "resume:=true to go on with that run)");
  EXPECT_EQ(content_of(checkpoint_file(folder.path())), before);
  configuration.run.resume = true;
  EXPECT_EQ(starting_point(configuration)->totals.count(), 13u);
}

TEST(StartingPoint, TakesNoTwoLaunchesWithoutANameForTheSame) {
  const TemporaryFolder folder;
  Configuration configuration = paper_run(folder.path());
  configuration.run.launch_id.clear();
  write_checkpoint(folder.path(), checkpoint_of(configuration, 13));
  EXPECT_NE(refusal(configuration), "");
}

TEST(StartingPoint, NamesWhatDiffersInARunOfAnotherConfiguration) {
  const TemporaryFolder folder;
  Configuration configuration = paper_run(folder.path());
  write_checkpoint(folder.path(), checkpoint_of(configuration, 13));
  configuration.run.resume = true;
  configuration.run.seed = 2;
  configuration.model.default_vehicle().noise_variance = 0.25;
  EXPECT_EQ(refusal(configuration), "output: " + folder.path() +
                                        ": holds a run of another configuration: noise_variance is 0.6 there and "
                                        "0.25 here, seed is 1 there and 2 here");
}

TEST(StartingPoint, RefusesEveryOtherConfigurationEvenOfTheSameLaunch) {
  const TemporaryFolder folder;
  const Configuration same = paper_run(folder.path());
  write_checkpoint(folder.path(), checkpoint_of(same, 13));
  Configuration other = same;
  other.run.steps = 4;
  EXPECT_NE(refusal(other).find("steps is 3 there and 4 here"), std::string::npos);
  other = same;
  other.run.followers = 3;
  EXPECT_NE(refusal(other).find("followers is 2 there and 3 here"), std::string::npos);
  EXPECT_NE(refusal(paper_run(folder.path(), 2.4)).find("time_headway is 3.2 there and 2.4 here"), std::string::npos);
}

TEST(StartingPoint, AllowsMoreRealizationsAndOtherBatchesThanBefore) {
  const TemporaryFolder folder;
  Configuration configuration = paper_run(folder.path());
  write_checkpoint(folder.path(), checkpoint_of(configuration, 20));
  EXPECT_EQ(starting_point(configuration)->totals.count(), 20u);
  configuration.run.realizations = 1000;
  configuration.run.batch = 7;
  configuration.run.hosting = Hosting::one_process;
  EXPECT_EQ(starting_point(configuration)->totals.count(), 20u);
}

TEST(StartingPoint, RefusesFewerRealizationsThanThereAre) {
  const TemporaryFolder folder;
  Configuration configuration = paper_run(folder.path());
  write_checkpoint(folder.path(), checkpoint_of(configuration, 20));
  configuration.run.realizations = 19;
  EXPECT_EQ(refusal(configuration),
            "realizations: 19: must be at least the 20 that " + folder.path() + " holds already");
}

TEST(StartingPoint, RefusesAFolderThatCannotBeWritten) {
  const TemporaryFolder folder;
  const std::string file = folder.file("file", "content");
  for (const std::string& path : {file, file + "/below"}) {
    const std::string said = refusal(paper_run(path));
    EXPECT_EQ(said.find("output: " + path + ": cannot be made: "), 0u) << said;
    EXPECT_NE(said.find(": must be a folder that can be written"), std::string::npos);
  }
  EXPECT_EQ(content_of(file), "content");
}

TEST(StartingPoint, RefusesADamagedCheckpointAndLeavesIt) {
  const TemporaryFolder folder;
  const std::string file = folder.file("checkpoint.cbor", "damaged");
  EXPECT_EQ(refusal(paper_run(folder.path())).find("output: " + file + ": is not a checkpoint that can be read"), 0u);
  EXPECT_EQ(content_of(file), "damaged");
}

TEST(StartingPoint, RefusesResultsWithoutACheckpointAndLeavesThem) {
  for (const char* name : {"statistics.csv", "summary.json"}) {
    const TemporaryFolder folder;
    folder.file(name, "of another run");
    Configuration configuration = paper_run(folder.path());
    for (const bool resume : {false, true}) {
      configuration.run.resume = resume;
      EXPECT_EQ(refusal(configuration),
                "output: " + folder.path() +
                    ": holds results already, which are never overwritten, and no checkpoint to continue from: "
                    "must be another folder");
    }
    EXPECT_EQ(content_of(folder / name), "of another run");
  }
}

TEST(StartingPoint, NamesWhatOnlyOneOfTheTwoConfigurationsHas) {
  const TemporaryFolder folder;
  Configuration configuration = paper_run(folder.path());
  configuration.model.default_vehicle().link.delay = 1;
  write_checkpoint(folder.path(), checkpoint_of(configuration, 13));
  EXPECT_NE(refusal(paper_run(folder.path())).find("channel is {\"delay\":1} there and null here"), std::string::npos);
}

TEST(StartingPoint, RefusesAShard) {
  const TemporaryFolder folder;
  const Configuration configuration = paper_run(folder.path());
  Checkpoint checkpoint = checkpoint_of(configuration, 13);
  checkpoint.shard = {{"index", 0}};
  write_checkpoint(folder.path(), checkpoint);
  EXPECT_EQ(refusal(configuration), "output: " + folder.path() + ": holds a shard of a run: must be another folder");
}

}  // namespace
}  // namespace platoon
