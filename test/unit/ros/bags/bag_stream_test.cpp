#include "stochastic_platoon/ros/bags/bag_stream.hpp"

#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <std_msgs/String.h>

#include <set>
#include <string>
#include <vector>

#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/ros/bags/bag_writer.hpp"
#include "unit/damage.hpp"
#include "unit/messages.hpp"
#include "unit/temporary_folder.hpp"

namespace platoon {
namespace {

using stochastic_platoon::ErrorStatistics;
using stochastic_platoon::Position;

constexpr std::int64_t kSteps = 12;
const std::string kPosition = "/platoon/vehicle_1/position", kReceived = "/platoon/vehicle_1/predecessor_position",
                  kConfiguration = "/platoon/configuration";

/// Recordings of a vehicle's positions and its received positions, in batches of three steps.
class BagStreamTest : public testing::Test {
protected:
  // Records kSteps steps from `first` on, with `size` positions each; returns the file name.
  std::string record(const std::string& name, const std::string& compression, std::int64_t first = 0,
                     std::size_t size = 4, const std::string& configuration = "{}") const {
    BagWriter bag(folder_ / name, "", compression, {kConfiguration, configuration});
    for (std::int64_t step = first; step < first + kSteps; ++step) {
      Position message;
      message.header.stamp = ros::Time(100.0 + 0.01 * static_cast<double>(step));
      message.step = step;
      message.position.assign(size, 0.1 * static_cast<double>(step));
      bag.write(kPosition, message);
      bag.write(kReceived, message);
      bag.end_step(step % 3 == 2);
    }
    ErrorStatistics statistics;
    statistics.header.stamp = ros::Time(100.0);
    bag.write("/platoon/error_statistics", statistics);
    bag.close();
    return folder_ / name;
  }

  struct Found {
    std::vector<std::int64_t> positions, received;
    std::size_t others = 0;
    std::set<std::string> foreign_topics = {};
    std::string ending = {};
  };

  // `Messages`: a BagStream or RecordedMessages.
  template <typename Messages>
  static Found read_all(Messages messages) {
    Found found;
    while (const std::optional<RecordedMessage> message = messages.next()) {
      if (message->topic.kind == PlatoonTopic::Kind::position) {
        found.positions.push_back(message->position()->step);
      } else if (message->topic.kind == PlatoonTopic::Kind::predecessor_position) {
        found.received.push_back(message->position()->step);
      } else {
        ++found.others;
      }
    }
    found.foreign_topics = messages.foreign_topics();
    found.ending = messages.ending();
    return found;
  }

  static bool any_topic(const PlatoonTopic&) { return true; }

  static Found read(const BagSource& source) { return read_all(BagStream(source, any_topic)); }

  /// Why the source is rejected, or an empty string.
  static std::string rejection(const BagSource& source) {
    return message_of<BagError>([&source] { read(source); });
  }

  static std::vector<std::int64_t> steps(std::int64_t end) {
    std::vector<std::int64_t> all;
    for (std::int64_t step = 0; step < end; ++step) all.push_back(step);
    return all;
  }

  /// Each message of a bag with its topic and time.
  static std::vector<std::string> raw(const std::string& file) {
    std::vector<std::string> all;
    const rosbag::Bag bag(file);
    for (const rosbag::MessageInstance& message : rosbag::View(bag)) {
      std::string bytes(message.size(), ' ');
      ros::serialization::OStream stream(reinterpret_cast<std::uint8_t*>(bytes.data()), message.size());
      message.write(stream);
      all.push_back(message.getTopic() + " " + std::to_string(message.getTime().toNSec()) + " " + bytes);
    }
    return all;
  }

  TemporaryFolder folder_;
};

TEST_F(BagStreamTest, ReadsAWholeRecording) {
  for (const char* compression : {"none", "lz4"}) {
    const Found found = read({{record("run.bag", compression)}});
    EXPECT_EQ(found.positions, steps(kSteps)) << compression;
    EXPECT_EQ(found.received, steps(kSteps)) << compression;
    EXPECT_EQ(found.others, 2u) << compression;
  }
}

// 509 is coprime to the period of repeated contents in bits. A copy in lz4 may begin elsewhere in the same bytes.
TEST_F(BagStreamTest, RejectsAFileWithAFlippedBitThatChangesAMessage) {
  for (const char* compression : {"none", "lz4"}) {
    const std::string file = record("run.bag", compression), content = content_of(file);
    for (std::size_t bit = 0; bit < 8 * content.size(); bit += 509) {
      for (const Accept accept : {Accept::whole, Accept::cut}) {
        const BagSource source{{folder_.file("damaged.bag", with_flipped_bit(content, bit))}, accept};
        if (!rejection(source).empty()) continue;
        if (accept == Accept::cut) {
          EXPECT_EQ(read(source).positions, steps(kSteps)) << compression << ", bit " << bit;
        } else {
          EXPECT_STREQ(compression, "lz4") << "bit " << bit;
          EXPECT_EQ(raw(source.files.front()), raw(file)) << "bit " << bit;
        }
      }
    }
  }
}

// rosbag uses these values as offsets within the chunk.
TEST_F(BagStreamTest, RejectsAFileWithAnyFlippedBitInItsIndex) {
  const std::string file = record("run.bag", "none"), content = content_of(file);
  const std::size_t index = content.find("count=", 4200);  // after the header of the file and the chunk
  ASSERT_NE(index, std::string::npos);
  for (std::size_t bit = 8 * index; bit < 8 * content.size(); bit += 31) {
    EXPECT_NE(rejection({{folder_.file("damaged.bag", with_flipped_bit(content, bit))}}), "") << bit;
  }
}

TEST_F(BagStreamTest, ReadsWholeStepsOfAFileThatIsCutAnywhere) {
  for (const char* compression : {"none", "lz4"}) {
    const std::string content = content_of(record("run.bag", compression));
    std::size_t before = 0;
    for (std::size_t size = 5000; size < content.size(); size += 97) {
      const std::string cut = folder_.file("cut.bag", content.substr(0, size));
      EXPECT_NE(rejection({{cut}}), "") << compression << ", byte " << size;
      const Found found = read({{cut}, Accept::cut});
      EXPECT_NE(found.ending, "") << compression << ", byte " << size;
      EXPECT_EQ(found.positions, steps(static_cast<std::int64_t>(found.positions.size())));
      EXPECT_EQ(found.received, found.positions);
      EXPECT_EQ(found.positions.size() % 3, 0u) << "checksums are behind three steps";
      EXPECT_GE(found.positions.size(), before);
      before = found.positions.size();
    }
    EXPECT_EQ(before, static_cast<std::size_t>(kSteps)) << compression;
  }
}

TEST_F(BagStreamTest, ReadsADamagedFileUpToTheDamageIfRequested) {
  const std::string content = content_of(record("run.bag", "none", 0, 5000));
  const double middle = 0.5;  // the position of step 5
  const std::size_t place = content.find(std::string(reinterpret_cast<const char*>(&middle), sizeof(middle)));
  ASSERT_NE(place, std::string::npos);
  const std::string damaged = folder_.file("damaged.bag", with_flipped_bit(content, 8 * place));
  EXPECT_NE(rejection({{damaged}, Accept::cut}), "");
  const Found found = read({{damaged}, Accept::damaged});
  EXPECT_TRUE(contains(found.ending, "is damaged"));
  EXPECT_EQ(found.positions, steps(static_cast<std::int64_t>(found.positions.size())));
  EXPECT_GE(found.positions.size(), 3u);
  EXPECT_LE(found.positions.size(), 5u);
}

TEST_F(BagStreamTest, ReadsSeveralFilesInTheOrderOfTheirTimes) {
  const std::string first = record("run_2.bag", "none"), second = record("run_10.bag", "lz4", kSteps);
  const Found found = read({{second, first}});
  EXPECT_EQ(found.positions, steps(2 * kSteps));
}

TEST_F(BagStreamTest, RejectsFilesOfSeveralRunsBeforeItReadsThem) {
  const std::string one = record("one.bag", "none"), two = record("two.bag", "none", kSteps, 4, "{\"run\": 2}");
  const std::string reason = one + ": holds more than one run of a platoon: must hold one";
  EXPECT_EQ(message_of<BagError>([&] { BagStream({{one, two}}, any_topic); }), reason);
  EXPECT_EQ(message_of<BagError>([&] { BagStream({{one, one, two}}, any_topic); }), reason);
  EXPECT_EQ(read({{two}}).positions.size(), static_cast<std::size_t>(kSteps));
}

TEST_F(BagStreamTest, RejectsTheConfigurationOfASecondRunWhenItGetsThere) {
  const std::string file = folder_ / "both.bag";
  rosbag::Bag bag(file, rosbag::bagmode::Write);
  std_msgs::String configuration;
  const auto write = [&](const char* text) {
    configuration.data = text;
    bag.write(kConfiguration, ros::Time(1.0), configuration);
    bag.write(kPosition, ros::Time(1.0), Position());
  };
  write("{}");
  write("{}");  // a latched message is sent again
  write("{\"run\": 2}");
  bag.close();
  BagStream stream({{file}, Accept::whole, true},
                   [](const PlatoonTopic& topic) { return topic.kind == PlatoonTopic::Kind::position; });
  EXPECT_TRUE(stream.next());
  EXPECT_TRUE(stream.next());
  EXPECT_TRUE(contains(message_of<BagError>([&] { stream.next(); }), "holds more than one run"));
}

TEST_F(BagStreamTest, RejectsAFileWithoutChecksumsUnlessItMayBeUnverified) {
  const std::string file = folder_ / "plain.bag";
  rosbag::Bag bag(file, rosbag::bagmode::Write);
  std_msgs::String configuration;
  bag.write(kConfiguration, ros::TIME_MIN, configuration);
  bag.write(kPosition, ros::Time(1.0), Position());
  bag.close();
  EXPECT_TRUE(contains(rejection({{file}}), "holds no checksums"));
  EXPECT_TRUE(contains(rejection({{file}, Accept::cut}), "holds no checksums"));
  EXPECT_EQ(read({{file}, Accept::whole, true}).positions.size(), 1u);
}

// As rosbag compress writes it. The monitor's statistics are stamped ahead of the steps that are written.
TEST_F(BagStreamTest, ReadsARecordingWhoseMessagesAreSortedByTime) {
  const std::string file = folder_ / "run.bag", sorted = folder_ / "sorted.bag";
  BagWriter writer(file, "", "none", {kConfiguration, "{}"});
  const auto time = [](std::int64_t step) { return ros::Time(100.0 + 0.01 * static_cast<double>(step)); };
  for (std::int64_t step = 0; step < kSteps; ++step) {
    ErrorStatistics statistics;
    statistics.header.stamp = time(step + 2);
    writer.write("/platoon/error_statistics", statistics);
    Position message;
    message.header.stamp = time(step);
    message.step = step;
    message.position.assign(4, 0.1);
    writer.write(kPosition, message);
    writer.end_step(step % 3 == 2);
  }
  writer.close();
  {
    const rosbag::Bag given(file);
    rosbag::Bag written(sorted, rosbag::bagmode::Write);
    for (const rosbag::MessageInstance& message : rosbag::View(given))
      written.write(message.getTopic(), message.getTime(), message);
  }
  for (const std::string& bag : {file, sorted}) {
    const Found found = read({{bag}});
    EXPECT_EQ(found.positions, steps(kSteps)) << bag;
    EXPECT_EQ(found.others, 1u + kSteps) << bag;  // the configuration and the statistics
  }
}

TEST_F(BagStreamTest, RejectsMessagesBehindTheLastChecksum) {
  const std::string file = record("run.bag", "none");
  rosbag::Bag bag(file, rosbag::bagmode::Append);
  bag.write("/chatter", ros::Time(200.0), std_msgs::String());
  bag.close();
  EXPECT_EQ(read({{file}}).foreign_topics, std::set<std::string>{"/chatter"});
  bag.open(file, rosbag::bagmode::Append);
  bag.write(kPosition, ros::Time(200.0), Position());
  bag.close();
  EXPECT_TRUE(contains(rejection({{file}}), "its last messages have no checksum"));
}

TEST_F(BagStreamTest, ReadsTheConfigurationAndTheLastStepsFromTheEndOfAFile) {
  const std::string file = record("run.bag", "none", 0, 100000);  // a chunk for each step
  RecordedMessages messages(file, {{file}, Accept::damaged}, any_topic);
  EXPECT_FALSE(messages.skip_to_last_chunks(3));
  const Found found = read_all(std::move(messages));
  EXPECT_EQ(found.others, 2u);
  ASSERT_FALSE(found.positions.empty());
  EXPECT_GT(found.positions.front(), kSteps / 2);
  EXPECT_EQ(found.positions.back(), kSteps - 1);
  EXPECT_TRUE(RecordedMessages(file, {{file}, Accept::damaged}, any_topic).skip_to_last_chunks(1000));
}

}  // namespace
}  // namespace platoon
