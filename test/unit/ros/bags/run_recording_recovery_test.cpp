// A recording whose recorder was stopped or killed.

#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <utility>

#include "unit/ros/bags/run_recording_fixture.hpp"

namespace platoon {
namespace {

using RunRecordingRecoveryTest = RunRecordingTest;

TEST_F(RunRecordingRecoveryTest, ContinuesBehindTheWholeBatchesOfTheSameLaunch) {
  set_batches(3, 1);
  {
    RunRecording stopped = recording();
    send(stopped, 1, 0);
    send(stopped, 2, 0);  // repeated for another receiver
    send(stopped, 2, 1);
    send(stopped, 2, 2, 1);
    stopped.stop();
  }
  RunRecording recorder = recording();
  EXPECT_EQ(recorder.arrivals().committed(), 2u);
  send(recorder, 3, 2);
  finish(recorder);
  EXPECT_EQ(places_in(bag_), whole({{1, 0}, {2, 1}, {3, 2}}));
}

TEST_F(RunRecordingRecoveryTest, JoinsTheFilesOfManyKilledRecorders) {
  set_batches(6, kSome);
  for (std::uint32_t attempt = 1; attempt <= 5; ++attempt) {
    RunRecording killed = recording();
    const std::uint64_t first = (attempt - 1) * kSome;
    EXPECT_EQ(killed.arrivals().committed(), first);
    send(killed, attempt, first);
    kill_in(killed, attempt, first + kSome);
    EXPECT_EQ(folder_.entries().size(), attempt);
  }
  RunRecording recorder = recording();
  send(recorder, 6, 5 * kSome);
  EXPECT_TRUE(recorder.needs_rewriting());
  finish(recorder);
  ASSERT_TRUE(recorder.finished());
  EXPECT_EQ(places_in(bag_),
            whole({{1, 0}, {2, kSome}, {3, 2 * kSome}, {4, 3 * kSome}, {5, 4 * kSome}, {6, 5 * kSome}}));
  EXPECT_EQ(folder_.entries(), Names{"run.bag"});
}

TEST_F(RunRecordingRecoveryTest, OverwritesAFileWithoutAWholeBatch) {
  set_batches(2, kSome);
  for (std::uint32_t attempt = 1; attempt <= 3; ++attempt) {
    RunRecording killed = recording();
    kill_in(killed, attempt, 0);
    EXPECT_EQ(folder_.entries(), Names{"run.bag.active"});
  }
  std::filesystem::resize_file(bag_ + ".active", 0);  // killed before its first byte
  EXPECT_EQ(recording().arrivals().committed(), 0u);
}

TEST_F(RunRecordingRecoveryTest, ReadsOnlyTheEndOfTheUnfinishedFile) {
  constexpr std::uint64_t kMany = 200000;  // a chunk for each message
  set_batches(8, kMany);
  // Bytes whose damage would stop a reader of the whole file, in the middle of the file.
  const std::vector<std::pair<std::string, std::string>> marks{{"none", std::string("op=") + '\2'},
                                                               {"lz4", "compression=lz4"}};
  for (const auto& [compression, mark] : marks) {
    configuration_.run.record_compression = compression;
    configuration_.run.record = folder_ / compression + ".bag";
    {
      RunRecording killed = recording();
      for (std::uint64_t batch = 0; batch < 3; ++batch) send(killed, 1, batch * kMany);
      kill_in(killed, 1, 3 * kMany);
    }
    const std::string active = configuration_.run.record + ".active";
    std::string content = content_of(active);
    const std::size_t at = content.find(mark, content.size() / 2);
    ASSERT_NE(at, std::string::npos);
    content.replace(at + (compression == "lz4" ? 60 : 0), 3, "xxx");
    folder_.file(compression + ".bag.active", content);
    std::size_t messages = 0;
    BagStream positions({{active}, Accept::damaged}, is_position);
    while (positions.next()) ++messages;
    EXPECT_NE(positions.ending(), "");
    EXPECT_LT(messages, 3u * 3u * 4u) << compression;  // vehicles, batches, steps

    EXPECT_EQ(recording().arrivals().committed(), 3 * kMany) << compression;
  }
}

// A disk rarely loses accepted data; the recorder must always notice.
TEST_F(RunRecordingRecoveryTest, RepeatsBatchesThatHaveBecomeUnreadable) {
  set_batches(3, kSome);
  {
    RunRecording killed = recording();
    send(killed, 1, 0);
    send(killed, 1, kSome);
    kill_in(killed, 1, 2 * kSome);
  }
  RunRecording recorder = recording();
  ASSERT_EQ(recorder.arrivals().committed(), 2 * kSome);
  const std::string aside = bag_ + ".active.1";
  std::filesystem::resize_file(aside, std::filesystem::file_size(aside) * 6 / 10);  // in the second batch
  send(recorder, 2, 2 * kSome);
  finish(recorder);
  EXPECT_FALSE(recorder.finished());
  EXPECT_EQ(recorder.arrivals().committed(), kSome);
  send(recorder, 3, kSome);
  send(recorder, 3, 2 * kSome);
  ASSERT_TRUE(recorder.ready_to_finish());
  recorder.finish();
  EXPECT_TRUE(recorder.finished());
  EXPECT_EQ(places_in(bag_), whole({{1, 0}, {3, kSome}, {3, 2 * kSome}}));
}

TEST_F(RunRecordingRecoveryTest, HasNoBatchTwiceIfTheRecorderIsKilledWhileItJoinsFiles) {
  set_batches(3, kSome);
  {
    RunRecording killed = recording();
    send(killed, 1, 0);
    kill_in(killed, 1, kSome);
  }
  {
    RunRecording killed = recording();
    send(killed, 2, kSome);
    std::filesystem::copy(bag_ + ".active.1", folder_ / "aside");
    killed.stop();
  }
  EXPECT_FALSE(std::filesystem::exists(bag_ + ".active.1"));
  std::filesystem::rename(folder_ / "aside", bag_ + ".active.1");  // the kill came before its end
  RunRecording recorder = recording();
  EXPECT_EQ(recorder.arrivals().committed(), 2 * kSome);
  send(recorder, 3, 2 * kSome);
  finish(recorder);
  EXPECT_EQ(places_in(bag_), whole({{1, 0}, {2, kSome}, {3, 2 * kSome}}));
}

TEST_F(RunRecordingRecoveryTest, JoinsAllAttemptsOfAnEndlessRunThatIsStopped) {
  set_batches(1, kSome);
  configuration_.run.steps = 0;
  for (std::uint32_t attempt = 1; attempt <= 2; ++attempt) {
    RunRecording killed = recording();
    kill_in(killed, attempt, 0);
  }
  RunRecording recorder = recording();
  send(recorder, 3, 0);
  recorder.stop();
  EXPECT_EQ(folder_.entries(), Names{"run.bag.active"});
  std::set<std::uint32_t> attempts;
  BagStream positions({{bag_ + ".active"}}, is_position);
  while (const std::optional<RecordedMessage> message = positions.next()) attempts.insert(message->position()->attempt);
  EXPECT_EQ(attempts, (std::set<std::uint32_t>{1, 2, 3}));
}

}  // namespace
}  // namespace platoon
