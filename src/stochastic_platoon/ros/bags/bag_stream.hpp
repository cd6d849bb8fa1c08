#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "stochastic_platoon/ros/bags/recorded_messages.hpp"

namespace platoon {

/// The messages of a recording, one at a time, several files as one in the order of their first positions: for those
/// who must not read ahead. Throws BagError as read_bags() does.
class BagStream {
public:
  /// Of the topics that `wanted` wants.
  BagStream(const BagSource& source, RecordedMessages::Wanted wanted);

  /// The next one; none at the end.
  std::optional<RecordedMessage> next();

  /// Of the files read so far: topics that are none of a platoon, and why reading ended, where a file ended early.
  const std::set<std::string>& foreign_topics() const { return foreign_topics_; }
  const std::string& ending() const { return ending_; }

  /// Bytes read, and bytes of all files.
  std::uint64_t position() const { return before_ + (present_ ? present_->position() : 0); }
  std::uint64_t size() const { return size_; }

private:
  BagSource source_;
  RecordedMessages::Wanted wanted_;
  std::vector<std::string> files_;  ///< to be read, the next one last
  std::unique_ptr<RecordedMessages> present_;
  std::uint64_t before_ = 0;  ///< bytes of the files that were read
  std::uint64_t size_ = 0;
  std::set<std::string> foreign_topics_;
  std::string ending_;
};

}  // namespace platoon
