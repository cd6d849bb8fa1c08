#pragma once

#include <gtest/gtest.h>

#include <boost/make_shared.hpp>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "stochastic_platoon/ros/bags/bag_stream.hpp"
#include "stochastic_platoon/ros/bags/run_recording.hpp"
#include "unit/paper_run.hpp"
#include "unit/temporary_folder.hpp"

namespace platoon {

/// A run of two followers and steps -1 .. 2, whose messages the test sends to a recording.
class RunRecordingTest : public testing::Test {
protected:
  using Position = stochastic_platoon::Position;
  using Place = std::tuple<std::uint32_t, std::uint64_t, std::int64_t>;  // attempt, first realization, step
  using Names = std::vector<std::string>;
  static constexpr std::size_t kStreams = 5;
  static constexpr std::uint64_t kSome = 2000;  // positions in a message

  RunRecordingTest() {
    configuration_.run.record = bag_;
    configuration_.run.record_compression = "none";
  }

  void set_batches(std::uint64_t batches, std::uint64_t batch) {
    configuration_.run.realizations = batches * batch;
    configuration_.run.batch = batch;
  }

  /// A new recording, which continues an unfinished file.
  RunRecording recording() const { return RunRecording(configuration_, "/platoon"); }

  DropReason send_one(RunRecording& recorder, std::size_t stream, const Place& place) const {
    const auto message = boost::make_shared<Position>();
    std::tie(message->attempt, message->first_realization, message->step) = place;
    message->header.stamp = ros::Time(1000.0 + message->attempt + 0.001 * static_cast<double>(message->step));
    message->position.assign(configuration_.run.batch, static_cast<double>(stream));
    return recorder.receive(stream, message);
  }

  /// Sends steps -1 .. last of a batch, one stream after the other.
  void send(RunRecording& recorder, std::uint32_t attempt, std::uint64_t first, std::int64_t last = 2) const {
    for (std::size_t stream = 0; stream < kStreams; ++stream) {
      for (std::int64_t step = -1; step <= last; ++step)
        ASSERT_EQ(send_one(recorder, stream, {attempt, first, step}), DropReason::none);
    }
  }

  /// Sends the final statistics and finishes the recording.
  void finish(RunRecording& recorder) const {
    stochastic_platoon::ErrorStatistics message;
    message.header.stamp = ros::Time(10000);
    message.realizations = configuration_.run.realizations;
    message.step = configuration_.run.steps - 1;
    recorder.receive(message);
    ASSERT_TRUE(recorder.ready_to_finish());
    recorder.finish();
  }

  /// Ends the recording like a kill in the middle of a batch: no index, and the last kilobytes are missing.
  void kill_in(RunRecording& recorder, std::uint32_t attempt, std::uint64_t first) const {
    send(recorder, attempt, first, 1);
    recorder.abandon();
  }

  static bool is_position(const PlatoonTopic& topic) { return topic.kind == PlatoonTopic::Kind::position; }

  /// The places of the positions of vehicle 0 in the file, in its order.
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

  /// The places of whole batches, each with its attempt and first realization.
  static std::vector<Place> whole(const std::vector<std::pair<std::uint32_t, std::uint64_t>>& batches) {
    std::vector<Place> places;
    for (const auto& [attempt, first] : batches) {
      for (std::int64_t step = -1; step <= 2; ++step) places.emplace_back(attempt, first, step);
    }
    return places;
  }

  TemporaryFolder folder_;
  std::string bag_ = folder_ / "run.bag";
  Configuration configuration_ = paper_run("");
};

}  // namespace platoon
