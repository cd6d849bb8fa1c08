#pragma once

#include <rosbag/bag.h>
#include <stochastic_platoon/ErrorStatistics.h>
#include <stochastic_platoon/Position.h>

#include <cstdint>
#include <string>

#include "stochastic_platoon/bags/write_behind.hpp"

namespace platoon {

struct RecordingOptions {
  std::string file;           ///< final name, ends in .bag
  std::uint64_t split_bytes;  ///< begin another file at the next batch beyond this size; 0: one file
  std::string compression;    ///< "none" or "lz4"
};

/// A bag, or a row of bags NAME_0.bag, NAME_1.bag, ... that is being written. A file bears its final name
/// only once it is whole and synced; until then it ends in ".active".
///
/// Recorded times are platoon time. Not thread-safe. Throws rosbag::BagException and std::runtime_error on
/// what the disk refuses.
class Recording {
public:
  /// Starts file number `part` (0 without splitting), under `suffix` beside its final name. `configuration`
  /// opens every file, latched, on configuration_topic.
  Recording(const RecordingOptions& options, std::string configuration_topic, std::string configuration,
            std::size_t part, const std::string& suffix);

  template <typename Message>
  void write(const std::string& topic, const Message& message) {
    bag_.write(topic, message.header.stamp, message);
    write_behind_.advance(bag_.getSize());
  }

  /// To be called between two batches: begins another file if this one has its size.
  void between_batches();

  /// Closes the file, syncs it and gives it its final name.
  void complete();

  /// Closes the file under the name it has.
  void close() { bag_.close(); }

  /// Renames the file while it is being written.
  void set_suffix(const std::string& suffix);

  /// Bytes written, over all files of this object.
  std::uint64_t bytes() const { return finished_bytes_ + (bag_.isOpen() ? bag_.getSize() : 0); }

private:
  void open();

  RecordingOptions options_;
  std::string configuration_topic_;
  std::string configuration_;
  std::size_t part_;
  std::string suffix_;
  std::uint64_t finished_bytes_ = 0;
  rosbag::Bag bag_;
  WriteBehind write_behind_;
};

/// Final name of a file of a recording.
std::string part_name(const RecordingOptions& options, std::size_t part);

constexpr char kActiveSuffix[] = ".active";

}  // namespace platoon
