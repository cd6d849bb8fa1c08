#pragma once

#include <rosbag/bag.h>
#include <stochastic_platoon/ErrorStatistics.h>
#include <stochastic_platoon/Position.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>

#include "stochastic_platoon/bags/write_behind.hpp"

namespace platoon {

/// What every file of a recording begins with, latched, so that it explains itself.
struct RecordedConfiguration {
  std::string topic;
  std::string json;
};

/// A bag that is being written. It bears its final name only once it is whole and synced.
///
/// Recorded times are platoon time. Not thread-safe. Throws rosbag::BagException and std::runtime_error on
/// what the disk refuses.
class BagWriter {
public:
  /// Begins the file `name` + `suffix` anew. `compression` is "none" or "lz4".
  BagWriter(std::string name, const std::string& suffix, const std::string& compression,
            const RecordedConfiguration& configuration);

  template <typename Message>
  void write(const std::string& topic, const Message& message) {
    bag_.write(topic, std::clamp(message.header.stamp, ros::TIME_MIN, ros::TIME_MAX), message);
    write_behind_.advance(bag_.getSize());
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
  void begin(const std::string& compression, const RecordedConfiguration& configuration);

  std::string name_;
  std::string suffix_;
  std::uint64_t closed_bytes_ = 0;
  rosbag::Bag bag_;
  WriteBehind write_behind_;
};

constexpr char kActiveSuffix[] = ".active";

/// The name of the count-th file, from 1 on, that was put aside unfinished while `name` was recorded.
std::string name_put_aside(const std::string& name, std::size_t count);

/// The first file that a recording named `name` has left, finished or not; empty if there is none.
std::string left_recording(const std::string& name);

}  // namespace platoon
