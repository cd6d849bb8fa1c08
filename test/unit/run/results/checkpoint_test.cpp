#include "stochastic_platoon/run/results/checkpoint.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <stdexcept>

#include "unit/damage.hpp"
#include "unit/run/results/checkpoint_fixture.hpp"
#include "unit/same_bits.hpp"

namespace platoon {
namespace {

TEST_F(CheckpointTest, IsReadBackToTheBit) {
  const Checkpoint written = checkpoint(13);
  write(written);
  EXPECT_EQ(folder_.entries(), std::vector<std::string>{"checkpoint.cbor"});
  const std::optional<Checkpoint> found = read();
  ASSERT_TRUE(found);
  EXPECT_EQ(found->identity, written.identity);
  EXPECT_EQ(found->launch_id, "this launch");
  EXPECT_EQ(found->tally.positions_received, 1234u);
  EXPECT_EQ(found->tally.attempts, 5u);
  EXPECT_EQ(found->tally.wall_seconds, 6.75);
  EXPECT_EQ(found->tally.platoon_time, 8901234567890123456u);
  expect_same_bits(found->totals.moments, written.totals.moments);
}

TEST_F(CheckpointTest, KeepsAveragesOverTimeToTheBit) {
  configuration_.run.steps = 0;
  configuration_.run.burn_in = 200;
  const std::vector<Moments> averages{{3, 0.1, 1.0 / 3.0}, {4, -0.0, 1e-300}};
  write({statistics_identity(configuration_), "this launch", {}, {}, averages});
  const std::optional<Checkpoint> found = starting_point(configuration_);
  ASSERT_TRUE(found);
  expect_same_bits(found->time_averages, averages);
  configuration_.run.burn_in = 100;
  EXPECT_TRUE(contains(rejection(), "burn_in is 200 there and 100 here"));
  configuration_.run.launch_id = "another launch";
  EXPECT_TRUE(contains(rejection(), "holds a run of averages over 3 steps"));
}

TEST_F(CheckpointTest, KeepsTheSmallestGaps) {
  Checkpoint written = checkpoint(6);
  written.totals.gaps = GapTable({2, 0.1, 1.5});
  written.totals.gaps.merge(1, {{-1.0 / 3.0, 99, 7}, 3, 4, {{-4, 1}, {12, 5}}});
  written.totals.gaps.merge(2, {{0.1, 5, 0}, 0, 2, {{1, 6}}});
  write(written);
  expect_same_gaps(read()->totals.gaps, written.totals.gaps);
}

TEST_F(CheckpointTest, KeepsTheBitsOfEveryDouble) {
  using Limits = std::numeric_limits<double>;
  const std::vector<double> values = {-0.0,  0.1,           1.0 / 3.0,          Limits::denorm_min(),
                                      1e300, Limits::max(), -Limits::epsilon(), 0.5,
                                      1e-45, 16777217.0,    Limits::infinity(), Limits::quiet_NaN()};
  MomentTable unusual(values.size());
  unusual.add(MomentBlock{{3, 0}, values, values});
  unusual.add(MomentBlock{{std::uint64_t{1} << 45, 45}, values, values});
  write({{}, "", {}, EnsembleTotals(unusual), {}});
  expect_same_bits(read()->totals.moments, unusual);
}

TEST_F(CheckpointTest, IsReplacedByThePreviousOneIfItIsDamaged) {
  write(8);
  write(13);
  EXPECT_EQ(read()->totals.count(), 13u);
  EXPECT_EQ(read()->damage, "");
  const std::string sound = content();
  const auto expect_previous = [this](const std::string& damaged, const std::string& how) {
    folder_.file("checkpoint.cbor", damaged);
    const std::optional<Checkpoint> found = read();
    ASSERT_TRUE(found) << how;
    EXPECT_EQ(found->totals.count(), 8u) << how;
    EXPECT_NE(found->damage, "") << how;
    EXPECT_EQ(found->launch_id, "this launch") << how;
  };
  for_each_damage(sound, expect_previous);
  for (std::size_t place = 0; place + 64 <= sound.size(); place += 64) {
    expect_previous(std::string(sound).replace(place, 64, 64, '\0'), "zeros from byte " + std::to_string(place));
  }
}

TEST_F(CheckpointTest, KeepsTheSoundOneWhereTheNextCannotBeWritten) {
  write(8);
  write(13);
  folder_.file("checkpoint.cbor", with_flipped_bit(content(), 1000));
  std::filesystem::create_directory(file() + ".part");
  EXPECT_THROW(write(21), std::system_error);
  EXPECT_EQ(read()->totals.count(), 8u);
  std::filesystem::remove(file() + ".part");
  write(21);
  EXPECT_EQ(read()->totals.count(), 21u);
}

TEST_F(CheckpointTest, IsRejectedIfItIsDamagedAndThereIsNoPreviousOne) {
  write(13);
  const std::string sound = content();
  for_each_damage(sound, [this](const std::string& damaged, const std::string& how) {
    folder_.file("checkpoint.cbor", damaged);
    EXPECT_TRUE(begins_with(message_of<std::runtime_error>([this] { read(); }),
                            file() + ": is not a checkpoint that can be read"))
        << how;
  });
  folder_.file("checkpoint.cbor", with_flipped_bit(sound, 8 * sound.size() - 1));
  EXPECT_TRUE(contains(rejection(), "its digest is not that of its content"));
}

TEST_F(CheckpointTest, IsRejectedIfItHasAnotherFormat) {
  write(13);
  std::string other = content();
  other.replace(other.find("checkpoint 3"), 12, "checkpoint 1");
  folder_.file("checkpoint.cbor", other);
  EXPECT_TRUE(contains(rejection(), "it does not begin with \"stochastic_platoon checkpoint 3\""));
}

TEST_F(CheckpointTest, IsThePreviousOneIfWritingTheLatestWasInterrupted) {
  write(8);
  std::filesystem::rename(file(), previous_checkpoint_file(folder_.path()));
  ASSERT_TRUE(read());
  EXPECT_EQ(read()->totals.count(), 8u);
}

TEST_F(CheckpointTest, ContinuesARunToTheSameBits) {
  BatchMoments rest(13, 7, kCells);
  const std::vector<double> values = {1.0, 2.5, -3.0, 0.1, 0.2, 0.3, 7.0};
  for (std::size_t c = 0; c < kCells; ++c) rest.set(c, values.data());
  MomentTable undisturbed = table(13);
  undisturbed.add(rest);
  write(13);
  MomentTable resumed = read()->totals.moments;
  resumed.add(rest);
  expect_same_bits(resumed, undisturbed);
}

TEST_F(CheckpointTest, IsAbsentInAnEmptyFolder) {
  EXPECT_FALSE(read());
  EXPECT_FALSE(read_checkpoint(folder_ / "none"));
}

// An existing file that cannot be opened must not be overwritten. (A link to itself, because root can read a file
// without permissions.)
TEST_F(CheckpointTest, IsNotIgnoredIfItCannotBeOpened) {
  std::filesystem::create_symlink("checkpoint.cbor", file());
  EXPECT_THROW(read(), std::runtime_error);
  EXPECT_NE(rejection(), "");
}

}  // namespace
}  // namespace platoon
