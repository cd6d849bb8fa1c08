#pragma once

#include <rosbag/bag.h>
#include <stochastic_platoon/Checksum.h>
#include <stochastic_platoon/ErrorStatistics.h>
#include <stochastic_platoon/Position.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>

#include "stochastic_platoon/ros/bags/message_digest.hpp"
#include "stochastic_platoon/ros/bags/write_behind.hpp"

namespace platoon {

/// What every file of a recording begins with, latched, so that it explains itself.
struct RecordedConfiguration {
  std::string topic;
  std::string json;
};

/// A bag that is being written. It bears its final name only once it is whole and synced.
///
/// Recorded times are platoon time. Checksums (msg/Checksum.msg) cover all messages: one behind the configuration, one
/// at the end of each batch and of a step where 16 kB have come together, the last one at the end of the file. Its time
/// is behind that of the step, and before the next step's: programs that sort by time, as `rosbag compress` does, leave
/// it in its place. Not thread-safe. Throws rosbag::BagException and std::runtime_error on what the disk refuses.
class BagWriter {
public:
  /// Begins the file `name` + `suffix` anew. `compression` is "none" or "lz4".
  BagWriter(std::string name, const std::string& suffix, const std::string& compression,
            const RecordedConfiguration& configuration);

  void write(const std::string& topic, const stochastic_platoon::Position& message) {
    record(topic, std::clamp(message.header.stamp, ros::TIME_MIN, ros::TIME_MAX), message);
  }

  /// Their time is that of the latest step, whenever they come.
  void write(const std::string& topic, const stochastic_platoon::ErrorStatistics& message) {
    record(topic, std::clamp(message.header.stamp, latest_, ros::TIME_MAX), message);
  }

  /// All positions of a step are written, the last one of a batch perhaps.
  void end_step(bool is_last) {
    if (is_last || uncovered_bytes_ >= kCovered) write_checksum();
  }

  /// Closes the file, syncs it and gives it its final name.
  void complete();

  /// Closes the file under the name it has.
  void close();

  /// Lets go of a file that could not be written: it stays as far as it came, and nothing throws.
  void abandon() noexcept;

  /// Renames the file while it is being written.
  void set_suffix(const std::string& suffix);

  /// Bytes written.
  std::uint64_t bytes() const { return bag_.isOpen() ? bag_.getSize() : closed_bytes_; }

private:
  static constexpr std::uint64_t kCovered = 1u << 14;        ///< bytes by one checksum, at least
  static constexpr std::uint64_t kCoveredAtMost = 1u << 24;  ///< bytes, and one message

  void begin(const std::string& compression, const RecordedConfiguration& configuration);
  template <typename Message>
  void record(const std::string& topic, const ros::Time& time, const Message& message) {
    if (uncovered_bytes_ >= kCoveredAtMost) write_checksum();
    bag_.write(topic, time, message);
    cover(topic, time, message);
    write_behind_.advance(bag_.getSize());
  }
  template <typename Message>
  void cover(const std::string& topic, const ros::Time& time, const Message& message) {
    checksum_.digest += message_digest(message, digest_seed(xxhash64(topic), time.toNSec()));
    ++checksum_.messages;
    uncovered_bytes_ += ros::serialization::serializationLength(message);
    latest_ = std::max(latest_, time);
  }
  void write_checksum();

  std::string name_;
  std::string suffix_;
  std::uint64_t closed_bytes_ = 0;
  std::string checksum_topic_;
  stochastic_platoon::Checksum checksum_;  ///< of what was written since the latest
  std::uint64_t uncovered_bytes_ = 0;
  ros::Time latest_ = ros::TIME_MIN;  ///< of all recorded times
  rosbag::Bag bag_;
  WriteBehind write_behind_;
};

constexpr char kActiveSuffix[] = ".active";

/// The name of the count-th file, from 1 on, that was put aside unfinished while `name` was recorded.
std::string name_put_aside(const std::string& name, std::size_t count);

/// The first file that a recording named `name` has left, finished or not; empty if there is none.
std::string left_recording(const std::string& name);

}  // namespace platoon
