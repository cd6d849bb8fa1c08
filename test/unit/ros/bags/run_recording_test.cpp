#include "stochastic_platoon/ros/bags/run_recording.hpp"

#include <gtest/gtest.h>

#include <boost/make_shared.hpp>
#include <filesystem>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "stochastic_platoon/ros/bags/bag_stream.hpp"
#include "unit/paper_run.hpp"
#include "unit/temporary_folder.hpp"

namespace platoon {
namespace {

using stochastic_platoon::ErrorStatistics;
using stochastic_platoon::Position;

constexpr std::uint64_t kSome = 2000;
constexpr std::uint64_t kManyPositions = 500000;  // 4 MB a message

/// A run of two followers and steps -1 .. 2; the test sends its messages.
class RunRecordingTest : public testing::Test {
protected:
  using Place = std::tuple<std::uint32_t, std::uint64_t, std::int64_t>;  // attempt, first realization, step

  Configuration run(std::uint64_t realizations, std::uint64_t batch) const {
    Configuration configuration = paper_run("");
    configuration.run.realizations = realizations;
    configuration.run.batch = batch;
    configuration.run.record = folder_ / "run.bag";
    configuration.run.record_compression = "none";
    return configuration;
  }

  static DropReason send_one(RunRecording* recorder, std::size_t stream, const Place& place, std::size_t size) {
    const auto message = boost::make_shared<Position>();
    std::tie(message->attempt, message->first_realization, message->step) = place;
    message->header.stamp = ros::Time(1000.0 + message->attempt + 0.001 * static_cast<double>(message->step));
    message->position.assign(size, static_cast<double>(stream));
    return recorder->receive(stream, message);
  }

  // Sends steps -1 .. last of a batch, one stream after the other.
  static void send(RunRecording* recorder, std::uint32_t attempt, std::uint64_t first, std::size_t size,
                   std::int64_t last = 2) {
    for (std::size_t stream = 0; stream < kStreams; ++stream) {
      for (std::int64_t step = -1; step <= last; ++step) {
        ASSERT_EQ(send_one(recorder, stream, {attempt, first, step}, size), DropReason::none);
      }
    }
  }

  static void send_final_statistics(RunRecording* recorder, const Configuration& configuration) {
    ErrorStatistics message;
    message.header.stamp = ros::Time(10000);
    message.realizations = configuration.run.realizations;
    message.step = configuration.run.steps - 1;
    recorder->receive(message);
  }

  // Ends the recording like a kill in the middle of a batch: no index, and the last kilobytes are missing.
  static void kill_in(RunRecording* recorder, std::uint32_t attempt, std::uint64_t first, std::size_t size) {
    send(recorder, attempt, first, size, 1);
    recorder->abandon();
  }

  static bool is_position(const PlatoonTopic& topic) { return topic.kind == PlatoonTopic::Kind::position; }

  // The places of the positions of vehicle 0 in the file, in its order.
  std::vector<Place> places_in(const std::string& file) const {
    std::vector<Place> places;
    std::size_t messages = 0;
    BagStream stream({{file}, Accept::damaged}, [](const PlatoonTopic& topic) {
      return is_position(topic) || topic.kind == PlatoonTopic::Kind::predecessor_position;
    });
    while (const std::optional<RecordedMessage> recorded = stream.next()) {
      ++messages;
      const Position& message = *recorded->position();
      if (is_position(recorded->topic) && recorded->topic.vehicle == 0)
        places.emplace_back(message.attempt, message.first_realization, message.step);
    }
    EXPECT_EQ(messages, kStreams * places.size());
    return places;
  }

  static std::vector<Place> whole_batch(std::uint32_t attempt, std::uint64_t first) {
    return {{attempt, first, -1}, {attempt, first, 0}, {attempt, first, 1}, {attempt, first, 2}};
  }

  static std::vector<Place> joined(std::vector<Place> places, const std::vector<Place>& more) {
    places.insert(places.end(), more.begin(), more.end());
    return places;
  }

  static constexpr std::size_t kStreams = 5;
  TemporaryFolder folder_;
  std::string bag_ = folder_ / "run.bag";
};

TEST_F(RunRecordingTest, WritesAStepOnceItHasArrivedFromEveryone) {
  const Configuration configuration = run(2, 1);
  RunRecording recorder(configuration, "/platoon");
  const std::uint64_t before = recorder.bytes();
  for (std::size_t stream = 0; stream + 1 < kStreams; ++stream) {
    send_one(&recorder, stream, {1, 0, -1}, 1);
    EXPECT_EQ(recorder.bytes(), before);
  }
  send_one(&recorder, kStreams - 1, {1, 0, -1}, 1);
  EXPECT_GT(recorder.bytes(), before);
}

TEST_F(RunRecordingTest, NamesTheFileWhenEverythingIsThere) {
  const Configuration configuration = run(2, 1);
  RunRecording recorder(configuration, "/platoon");
  send(&recorder, 1, 0, 1);
  send(&recorder, 1, 1, 1);
  EXPECT_FALSE(recorder.ready_to_finish());
  EXPECT_EQ(folder_.entries(), std::vector<std::string>{"run.bag.active"});
  send_final_statistics(&recorder, configuration);
  ASSERT_TRUE(recorder.ready_to_finish());
  recorder.finish();
  EXPECT_EQ(folder_.entries(), std::vector<std::string>{"run.bag"});
  EXPECT_EQ(places_in(bag_), joined(whole_batch(1, 0), whole_batch(1, 1)));
}

TEST_F(RunRecordingTest, OfAFileThatIsCompleteNeedsNothingMore) {
  const Configuration configuration = run(2, 1);
  {
    RunRecording recorder(configuration, "/platoon");
    send(&recorder, 1, 0, 1);
    send(&recorder, 1, 1, 1);
    send_final_statistics(&recorder, configuration);
    recorder.finish();
  }
  const RunRecording again(configuration, "/platoon");
  EXPECT_TRUE(again.finished());
  EXPECT_TRUE(again.arrivals().complete());
}

TEST_F(RunRecordingTest, LeavesNothingOfAnAttemptThatWasGivenUp) {
  const Configuration configuration = run(3, 1);
  RunRecording recorder(configuration, "/platoon");
  send(&recorder, 1, 0, 1);
  send(&recorder, 1, 1, 1, 1);
  const std::uint64_t before = recorder.bytes();
  send_one(&recorder, 0, {3, 1, -1}, 1);
  EXPECT_GE(recorder.bytes(), before) << "the run does not wait for a file that is written again";
  send(&recorder, 4, 1, 1);
  send(&recorder, 4, 2, 1);
  send_final_statistics(&recorder, configuration);
  ASSERT_TRUE(recorder.ready_to_finish());
  recorder.finish();
  EXPECT_EQ(places_in(bag_), joined(joined(whole_batch(1, 0), whole_batch(4, 1)), whole_batch(4, 2)));
  EXPECT_EQ(folder_.entries(), std::vector<std::string>{"run.bag"});
}

TEST_F(RunRecordingTest, OfTheSameLaunchGoesOnBehindTheWholeBatches) {
  const Configuration configuration = run(3, 1);
  {
    RunRecording killed(configuration, "/platoon");
    send(&killed, 1, 0, 1);
    send(&killed, 2, 0, 1);  // repeated for another receiver
    send(&killed, 2, 1, 1);
    send(&killed, 2, 2, 1, 1);
    killed.stop();
  }
  RunRecording recorder(configuration, "/platoon");
  EXPECT_EQ(recorder.arrivals().committed(), 2u);
  send(&recorder, 3, 2, 1);
  send_final_statistics(&recorder, configuration);
  ASSERT_TRUE(recorder.ready_to_finish());
  recorder.finish();
  EXPECT_EQ(places_in(bag_), joined(joined(whole_batch(1, 0), whole_batch(2, 1)), whole_batch(3, 2)));
}

TEST_F(RunRecordingTest, SplitsBetweenBatchesAndCleansTheFileItLeaves) {
  Configuration configuration = run(4 * kManyPositions, kManyPositions);
  configuration.run.record_split_mb = 100;  // MiB; a batch has 80 MB
  RunRecording recorder(configuration, "/platoon");
  send(&recorder, 1, 0, kManyPositions);
  send(&recorder, 1, kManyPositions, kManyPositions, 0);
  send(&recorder, 2, kManyPositions, kManyPositions);
  send(&recorder, 2, 2 * kManyPositions, kManyPositions);
  send(&recorder, 2, 3 * kManyPositions, kManyPositions);
  send_final_statistics(&recorder, configuration);
  ASSERT_TRUE(recorder.ready_to_finish());
  recorder.finish();
  EXPECT_EQ(places_in(folder_ / "run_0.bag"), joined(whole_batch(1, 0), whole_batch(2, kManyPositions)));
  EXPECT_EQ(places_in(folder_ / "run_1.bag"),
            joined(whole_batch(2, 2 * kManyPositions), whole_batch(2, 3 * kManyPositions)));
}

TEST_F(RunRecordingTest, PutsTogetherWhatManyKilledOnesLeft) {
  const Configuration configuration = run(6 * kSome, kSome);
  std::vector<Place> places;
  for (std::uint32_t attempt = 1; attempt <= 5; ++attempt) {
    RunRecording killed(configuration, "/platoon");
    const std::uint64_t first = (attempt - 1) * kSome;
    EXPECT_EQ(killed.arrivals().committed(), first);
    send(&killed, attempt, first, kSome);
    places = joined(places, whole_batch(attempt, first));
    kill_in(&killed, attempt, first + kSome, kSome);
    EXPECT_EQ(folder_.entries().size(), attempt);
  }
  RunRecording recorder(configuration, "/platoon");
  send(&recorder, 6, 5 * kSome, kSome);
  EXPECT_TRUE(recorder.needs_rewriting());
  send_final_statistics(&recorder, configuration);
  recorder.finish();
  ASSERT_TRUE(recorder.finished());
  EXPECT_EQ(places_in(bag_), joined(places, whole_batch(6, 5 * kSome)));
  EXPECT_EQ(folder_.entries(), std::vector<std::string>{"run.bag"});
}

TEST_F(RunRecordingTest, WritesOverAFileThatBroughtNothing) {
  const Configuration configuration = run(2 * kSome, kSome);
  for (std::uint32_t attempt = 1; attempt <= 3; ++attempt) {
    RunRecording killed(configuration, "/platoon");
    kill_in(&killed, attempt, 0, kSome);
    EXPECT_EQ(folder_.entries(), std::vector<std::string>{"run.bag.active"});
  }
  std::filesystem::resize_file(bag_ + ".active", 0);  // killed before its first byte
  const RunRecording recorder(configuration, "/platoon");
  EXPECT_EQ(recorder.arrivals().committed(), 0u);
}

TEST_F(RunRecordingTest, ReadsOnlyTheEndOfWhatItGoesOnBehind) {
  constexpr std::uint64_t kMany = 200000;  // a chunk for each message
  // Bytes whose damage would stop a reader of the whole file, in the middle of the file.
  const std::vector<std::pair<std::string, std::string>> marks{{"none", std::string("op=") + '\2'},
                                                               {"lz4", "compression=lz4"}};
  for (const auto& [compression, mark] : marks) {
    const TemporaryFolder folder;
    Configuration configuration = run(8 * kMany, kMany);
    configuration.run.record = folder / "run.bag";
    configuration.run.record_compression = compression;
    {
      RunRecording killed(configuration, "/platoon");
      for (std::uint64_t batch = 0; batch < 3; ++batch) send(&killed, 1, batch * kMany, kMany);
      kill_in(&killed, 1, 3 * kMany, kMany);
    }
    const std::string active = folder / "run.bag.active";
    std::string content = content_of(active);
    const std::size_t at = content.find(mark, content.size() / 2);
    ASSERT_NE(at, std::string::npos);
    content.replace(at + (compression == "lz4" ? 60 : 0), 3, "xxx");
    folder.file("run.bag.active", content);
    std::size_t messages = 0;
    BagStream positions({{active}, Accept::damaged}, is_position);
    while (positions.next()) ++messages;
    EXPECT_NE(positions.ending(), "");
    EXPECT_LT(messages, 3u * 3u * 4u) << compression;  // vehicles, batches, steps

    const RunRecording recorder(configuration, "/platoon");
    EXPECT_EQ(recorder.arrivals().committed(), 3 * kMany) << compression;
  }
}

// A disk rarely loses accepted data; the recorder must always notice.
TEST_F(RunRecordingTest, RecordsAgainWhatCannotBeReadAnyMore) {
  const Configuration configuration = run(3 * kSome, kSome);
  {
    RunRecording killed(configuration, "/platoon");
    send(&killed, 1, 0, kSome);
    send(&killed, 1, kSome, kSome);
    kill_in(&killed, 1, 2 * kSome, kSome);
  }
  RunRecording recorder(configuration, "/platoon");
  ASSERT_EQ(recorder.arrivals().committed(), 2 * kSome);
  const std::string aside = bag_ + ".active.1";
  std::filesystem::resize_file(aside, std::filesystem::file_size(aside) * 6 / 10);  // in the second batch
  send(&recorder, 2, 2 * kSome, kSome);
  send_final_statistics(&recorder, configuration);
  ASSERT_TRUE(recorder.ready_to_finish());
  recorder.finish();
  EXPECT_FALSE(recorder.finished());
  EXPECT_EQ(recorder.arrivals().committed(), kSome);
  send(&recorder, 3, kSome, kSome);
  send(&recorder, 3, 2 * kSome, kSome);
  ASSERT_TRUE(recorder.ready_to_finish());
  recorder.finish();
  EXPECT_TRUE(recorder.finished());
  EXPECT_EQ(places_in(bag_), joined(joined(whole_batch(1, 0), whole_batch(3, kSome)), whole_batch(3, 2 * kSome)));
}

TEST_F(RunRecordingTest, KilledWhileItPutTogetherLeavesNothingTwice) {
  const Configuration configuration = run(3 * kSome, kSome);
  {
    RunRecording killed(configuration, "/platoon");
    send(&killed, 1, 0, kSome);
    kill_in(&killed, 1, kSome, kSome);
  }
  {
    RunRecording killed(configuration, "/platoon");
    send(&killed, 2, kSome, kSome);
    std::filesystem::copy(bag_ + ".active.1", folder_ / "aside");
    killed.stop();
  }
  EXPECT_FALSE(std::filesystem::exists(bag_ + ".active.1"));
  std::filesystem::rename(folder_ / "aside", bag_ + ".active.1");  // the kill came before its end
  RunRecording recorder(configuration, "/platoon");
  EXPECT_EQ(recorder.arrivals().committed(), 2 * kSome);
  send(&recorder, 3, 2 * kSome, kSome);
  send_final_statistics(&recorder, configuration);
  recorder.finish();
  EXPECT_EQ(places_in(bag_), joined(joined(whole_batch(1, 0), whole_batch(2, kSome)), whole_batch(3, 2 * kSome)));
}

TEST_F(RunRecordingTest, StoppedInAnEndlessRunPutsAllAttemptsTogether) {
  Configuration configuration = run(kSome, kSome);
  configuration.run.steps = 0;
  for (std::uint32_t attempt = 1; attempt <= 2; ++attempt) {
    RunRecording killed(configuration, "/platoon");
    kill_in(&killed, attempt, 0, kSome);
  }
  RunRecording recorder(configuration, "/platoon");
  send(&recorder, 3, 0, kSome);
  recorder.stop();
  EXPECT_EQ(folder_.entries(), std::vector<std::string>{"run.bag.active"});
  std::set<std::uint32_t> attempts;
  BagStream positions({{bag_ + ".active"}}, is_position);
  while (const std::optional<RecordedMessage> message = positions.next()) attempts.insert(message->position()->attempt);
  EXPECT_EQ(attempts, (std::set<std::uint32_t>{1, 2, 3}));
}

TEST_F(RunRecordingTest, RefusesTheUnfinishedFileOfAnotherLaunch) {
  Configuration configuration = run(2, 1);
  {
    RunRecording other(configuration, "/platoon");
    other.stop();
  }
  configuration.run.launch_id = "another launch";
  EXPECT_THROW(RunRecording(configuration, "/platoon"), ConfigurationError);
  EXPECT_EQ(folder_.entries(), std::vector<std::string>{"run.bag.active"});
}

}  // namespace
}  // namespace platoon
