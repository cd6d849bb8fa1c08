#include "stochastic_platoon/ros/bags/run_recording.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <filesystem>
#include <stdexcept>

#include "stochastic_platoon/run/io/atomic_file.hpp"
#include "unit/ros/bags/run_recording_fixture.hpp"

namespace platoon {
namespace {

TEST_F(RunRecordingTest, WritesAStepOnceItHasArrivedOnAllStreams) {
  set_batches(2, 1);
  RunRecording recorder = recording();
  const std::uint64_t before = recorder.bytes();
  for (std::size_t stream = 0; stream + 1 < kStreams; ++stream) {
    send_one(recorder, stream, {1, 0, -1});
    EXPECT_EQ(recorder.bytes(), before);
  }
  send_one(recorder, kStreams - 1, {1, 0, -1});
  EXPECT_GT(recorder.bytes(), before);
}

TEST_F(RunRecordingTest, RenamesTheFileOnceEverythingHasArrived) {
  set_batches(2, 1);
  RunRecording recorder = recording();
  send(recorder, 1, 0);
  send(recorder, 1, 1);
  EXPECT_FALSE(recorder.ready_to_finish());
  EXPECT_EQ(folder_.entries(), Names{"run.bag.active"});
  finish(recorder);
  EXPECT_EQ(folder_.entries(), Names{"run.bag"});
  EXPECT_EQ(places_in(bag_), whole({{1, 0}, {1, 1}}));
}

// The topic is latched: after change_run a recorder receives those of the run before.
TEST_F(RunRecordingTest, IgnoresStatisticsBeforeTheFirstPosition) {
  set_batches(2, 1);
  RunRecording recorder = recording();
  const auto receive = [&recorder](std::int64_t step) {
    stochastic_platoon::ErrorStatistics message;
    message.header.stamp = ros::Time(1000.0);
    message.step = step;
    recorder.receive(message);
  };
  receive(77);
  send(recorder, 1, 0);
  receive(1);
  send(recorder, 1, 1);
  finish(recorder);
  std::vector<std::int64_t> found;
  BagStream stream({{bag_}},
                   [](const PlatoonTopic& topic) { return topic.kind == PlatoonTopic::Kind::error_statistics; });
  while (const std::optional<RecordedMessage> recorded = stream.next())
    found.push_back(std::get<stochastic_platoon::ErrorStatistics::Ptr>(recorded->content)->step);
  EXPECT_EQ(found, (std::vector<std::int64_t>{1, configuration_.run.steps - 1}));
}

TEST_F(RunRecordingTest, IsFinishedIfItsFileIsComplete) {
  set_batches(2, 1);
  {
    RunRecording recorder = recording();
    send(recorder, 1, 0);
    send(recorder, 1, 1);
    finish(recorder);
  }
  const RunRecording again = recording();
  EXPECT_TRUE(again.finished());
  EXPECT_TRUE(again.arrivals().complete());
}

TEST_F(RunRecordingTest, RemovesAbandonedAttempts) {
  set_batches(3, 1);
  RunRecording recorder = recording();
  send(recorder, 1, 0);
  send(recorder, 1, 1, 1);
  const std::uint64_t before = recorder.bytes();
  send_one(recorder, 0, {3, 1, -1});
  EXPECT_GE(recorder.bytes(), before) << "the run does not wait for a file that is written again";
  send(recorder, 4, 1);
  send(recorder, 4, 2);
  finish(recorder);
  EXPECT_EQ(places_in(bag_), whole({{1, 0}, {4, 1}, {4, 2}}));
  EXPECT_EQ(folder_.entries(), Names{"run.bag"});
}

TEST_F(RunRecordingTest, SplitsBetweenBatchesAndCleansTheFileItLeaves) {
  constexpr std::uint64_t kMany = 500000;  // 4 MB a message
  set_batches(4, kMany);
  configuration_.run.record_split_mb = 100;  // MiB; a batch has 80 MB
  RunRecording recorder = recording();
  send(recorder, 1, 0);
  send(recorder, 1, kMany, 0);
  for (const std::uint64_t batch : {1, 2, 3}) send(recorder, 2, batch * kMany);
  finish(recorder);
  EXPECT_EQ(places_in(folder_ / "run_0.bag"), whole({{1, 0}, {2, kMany}}));
  EXPECT_EQ(places_in(folder_ / "run_1.bag"), whole({{2, 2 * kMany}, {2, 3 * kMany}}));
}

TEST_F(RunRecordingTest, RejectsTheUnfinishedFileOfAnotherLaunch) {
  set_batches(2, 1);
  {
    RunRecording stopped = recording();
    send(stopped, 1, 0);
    stopped.stop();
  }
  configuration_.run.launch_id = "another launch";
  EXPECT_THROW(recording(), ConfigurationError);
  EXPECT_EQ(folder_.entries(), Names{"run.bag.active"});
}

TEST_F(RunRecordingTest, LeavesNoFileIfItIsStoppedBeforeTheFirstStep) {
  set_batches(2, 1);
  recording().stop();
  EXPECT_EQ(folder_.entries(), Names{});
}

TEST_F(RunRecordingTest, LeavesAFileUnchangedThatHasTheNameOfALaterPart) {
  constexpr std::uint64_t kMany = 10000;  // 1.6 MB a batch
  set_batches(3, kMany);
  configuration_.run.record_split_mb = 1;
  for (const char* suffix : {"", ".active"}) {
    const std::string other = folder_.file(std::string("run_1.bag") + suffix, "precious");
    RunRecording recorder = recording();
    EXPECT_THROW(send(recorder, 1, 0), ConfigurationError);
    EXPECT_EQ(content_of(other), "precious");
    EXPECT_EQ(places_in(folder_ / "run_0.bag"), whole({{1, 0}}));
    std::filesystem::remove(folder_ / "run_0.bag");
    std::filesystem::remove(other);
  }
}

TEST_F(RunRecordingTest, LeavesAFileUnchangedThatGetsItsNameMeanwhile) {
  set_batches(2, 1);
  {
    RunRecording recorder = recording();
    send(recorder, 1, 0);
    send(recorder, 1, 1);
    folder_.file("run.bag", "precious");
    EXPECT_THROW(finish(recorder), ConfigurationError);
  }
  EXPECT_THROW(recording(), ConfigurationError);
  EXPECT_EQ(content_of(bag_), "precious");
  EXPECT_EQ(folder_.entries(), (Names{"run.bag", "run.bag.active"}));
}

TEST_F(RunRecordingTest, FindsThePartsOfAnEarlierRecording) {
  for (const char* other : {"run_.bag", "run_1.bagged", "run_1a.bag", "other_1.bag", "run_1.csv", "run.bag"}) {
    folder_.file(other, "");
    EXPECT_EQ(left_part(bag_), "") << other;
  }
  for (const char* part : {"run_12.bag.active.3", "run_12.bag.active", "run_12.bag", "run_1.bag"}) {
    folder_.file(part, "");
    EXPECT_EQ(left_part(bag_), folder_ / part);
  }
}

TEST_F(RunRecordingTest, BeginsOnAFullDiskWithAnErrorAndLaterWithout) {
  set_batches(2, 1);
  ignore_file_size_signal();
  rlimit limit{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &limit), 0);
  for (const rlim_t size : {1u, 1000u, 4000u, 4100u, 20000u}) {
    const rlimit full{size, limit.rlim_max};
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &full), 0);
    bool failed = false;
    try {
      recording();
    } catch (const std::runtime_error&) {
      failed = true;
    }
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &limit), 0);
    EXPECT_EQ(failed, size < 20000) << size;
  }
  RunRecording recorder = recording();
  send(recorder, 1, 0);
  send(recorder, 1, 1);
  finish(recorder);
  EXPECT_EQ(folder_.entries(), Names{"run.bag"});
}

TEST_F(RunRecordingTest, EndsOnAFullDiskWithAnErrorAlsoIfItCompresses) {
  constexpr std::uint64_t kMany = 1000;  // 8 kB a message
  set_batches(2, kMany);
  configuration_.run.record_compression = "lz4";
  ignore_file_size_signal();
  rlimit limit{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &limit), 0);
  {
    RunRecording recorder = recording();
    send(recorder, 1, 0);
    send(recorder, 1, kMany);
    const rlimit full{5000, limit.rlim_max};
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &full), 0);
    EXPECT_THROW(finish(recorder), std::runtime_error);
  }  // must not end the program
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &limit), 0);
  RunRecording recorder = recording();
  send(recorder, 2, 0);
  send(recorder, 2, kMany);
  finish(recorder);
  EXPECT_EQ(places_in(bag_), whole({{2, 0}, {2, kMany}}));
}

}  // namespace
}  // namespace platoon
