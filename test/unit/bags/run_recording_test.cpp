#include "stochastic_platoon/bags/run_recording.hpp"

#include <gtest/gtest.h>

#include <boost/make_shared.hpp>
#include <string>
#include <tuple>
#include <vector>

#include "../paper_run.hpp"
#include "../temporary_folder.hpp"
#include "stochastic_platoon/bags/bag_reader.hpp"

namespace platoon {
namespace {

using stochastic_platoon::ErrorStatistics;
using stochastic_platoon::Position;

constexpr std::uint64_t kManyPositions = 500000;  // 4 MB a message

/// A run of two followers and steps -1 .. 2, its messages sent by hand.
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

  static Verdict send_one(RunRecording* recorder, std::size_t stream, const Place& place, std::size_t size) {
    const auto message = boost::make_shared<Position>();
    std::tie(message->attempt, message->first_realization, message->step) = place;
    message->header.stamp = ros::Time(1000.0 + message->attempt + 0.001 * static_cast<double>(message->step));
    message->position.assign(size, static_cast<double>(stream));
    return recorder->receive(stream, message);
  }

  // Steps -1 .. last of a batch, every stream ahead of the one behind it.
  static void send(RunRecording* recorder, std::uint32_t attempt, std::uint64_t first, std::size_t size,
                   std::int64_t last = 2) {
    for (std::size_t stream = 0; stream < kStreams; ++stream) {
      for (std::int64_t step = -1; step <= last; ++step) {
        ASSERT_EQ(send_one(recorder, stream, {attempt, first, step}, size), Verdict::in_turn);
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

  // What the positions of vehicle 0 in the file belong to, in its order.
  std::vector<Place> places_in(const std::string& file) const {
    std::vector<Place> places;
    std::size_t messages = 0;
    BagContent content;
    content.position = [&](const PlatoonTopic& topic, const Position::ConstPtr& message) {
      ++messages;
      if (topic.vehicle == 0)
        places.emplace_back(message->attempt, message->first_realization, message->step);
    };
    content.predecessor_position = [&](const PlatoonTopic&, const Position::ConstPtr&) { ++messages; };
    read_damaged_bag(file, content);
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
    send(&killed, 2, 0, 1);  // another receiver needs it again
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
