#pragma once

#include <rosbag/bag.h>
#include <stochastic_platoon/Checksum.h>
#include <stochastic_platoon/ErrorStatistics.h>
#include <stochastic_platoon/Position.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "stochastic_platoon/ros/bags/bag_source.hpp"
#include "stochastic_platoon/ros/bags/write_behind.hpp"

namespace platoon {

/// The latched first message of every file of a recording: model and run as JSON.
struct RecordedConfiguration {
  std::string topic;
  std::string json;
};

/// A bag that is being written. The file gets its final name when it is complete and synced.
///
/// Recorded times are platoon time. Checksums (msg/Checksum.msg) cover all messages: one after the configuration, one
/// at the end of each batch and of each step that completes 16 kB, the last one at the end of the file. The time of a
/// checksum lies between its step and the next one, so that programs that sort by time, such as `rosbag compress`, keep
/// its place. Not thread-safe. Throws rosbag::BagException and std::runtime_error on write errors.
class BagWriter {
public:
  /// Creates or overwrites the file `name` + `suffix`. `compression` is "none" or "lz4".
  BagWriter(std::string name, const std::string& suffix, const std::string& compression,
            const RecordedConfiguration& configuration);

  /// Closes the file, or abandons it if that fails.
  ~BagWriter();
  BagWriter(const BagWriter&) = delete;
  BagWriter& operator=(const BagWriter&) = delete;

  void write(const std::string& topic, const stochastic_platoon::Position& message);

  /// The recorded time is that of the latest message, not the stamp: in mid-run the stamp is ahead of the step being
  /// written, and the next checksum, which follows it, would lie behind messages that it does not cover.
  void write(const std::string& topic, const stochastic_platoon::ErrorStatistics& message);

  /// All positions of a step are written. `is_last`: it is the last step of a batch.
  void end_step(bool is_last);

  /// Closes the file, syncs it and gives it its final name.
  void complete();

  /// Closes the file under its present name.
  void close();

  /// Closes the file after a write error: the data written so far stays, and nothing throws.
  void abandon() noexcept;

  /// Renames the file while it is being written.
  void set_suffix(const std::string& suffix);

  /// Bytes written.
  std::uint64_t bytes() const { return bag_ && bag_->isOpen() ? bag_->getSize() : closed_bytes_; }

private:
  void begin(const std::string& compression, const RecordedConfiguration& configuration);
  template <typename Message>
  void record(const std::string& topic, const ros::Time& time, const Message& message);
  template <typename Message>
  void cover(const std::string& topic, const ros::Time& time, const Message& message);
  void write_checksum();

  std::string name_;
  std::string suffix_;
  std::uint64_t closed_bytes_ = 0;
  std::string checksum_topic_;
  stochastic_platoon::Checksum checksum_;  ///< the next one, over the messages since the latest
  std::uint64_t uncovered_bytes_ = 0;
  ros::Time latest_ = ros::TIME_MIN;                                    ///< latest recorded time
  std::unique_ptr<rosbag::Bag> bag_ = std::make_unique<rosbag::Bag>();  ///< none if it could not be closed
  std::optional<WriteBehind> write_behind_;                             ///< none until the file is open
};

/// The name of the unfinished file number `count` (from 1) that was put aside while `name` was recorded.
std::string name_put_aside(const std::string& name, std::size_t count);

/// The first existing file of a recording named `name`, finished or not; empty if there is none.
std::string left_recording(const std::string& name);

/// The same of a recording in parts: the first file STEM_<number>.bag, finished or not, beside `name` = STEM.bag.
/// Throws std::filesystem::filesystem_error if the folder cannot be read.
std::string left_part(const std::string& name);

/// The first file that a recording named `record`, STEM.bag, or one in parts would overwrite; empty if there is none.
std::string overwritten(const std::string& record, bool in_parts);

/// Throws ConfigurationError unless the bag, or one in parts, can be written without overwriting another; an empty name
/// is none.
void require_free_recording(const std::string& record, bool in_parts);

}  // namespace platoon
