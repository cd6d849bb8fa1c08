#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "stochastic_platoon/ros/bags/recorded_messages.hpp"

namespace platoon {

bool is_configuration(const PlatoonTopic& topic);

/// The messages of a recording, one at a time, for readers that must not read ahead. Several files are read as one, in
/// the order of their first positions. Throws BagError if a file is missing, is not a bag, or is in a state that
/// `source` does not accept, and if a configuration is not that of the run whose configuration came first: the
/// constructor looks at the beginning of each file, and next() at every configuration that it passes.
class BagStream {
public:
  /// Reads the topics for which `wanted` returns true.
  BagStream(const BagSource& source, RecordedMessages::Wanted wanted);

  /// The next message; none at the end.
  std::optional<RecordedMessage> next();

  /// For the files read so far: topics that do not belong to a platoon, and why reading ended if a file ended early.
  const std::set<std::string>& foreign_topics() const { return foreign_topics_; }
  const std::string& ending() const { return ending_; }

  /// Bytes read, and bytes of all files.
  std::uint64_t position() const { return before_ + (present_ ? present_->position() : 0); }
  std::uint64_t size() const { return size_; }

private:
  void require_one_run(const RecordedMessage& configuration);

  BagSource source_;
  RecordedMessages::Wanted wanted_;
  std::optional<RecordedMessage> configuration_;  ///< the first one
  std::vector<std::string> files_;                ///< not read yet, the next one last
  std::unique_ptr<RecordedMessages> present_;
  std::uint64_t before_ = 0;  ///< bytes of the files that were read
  std::uint64_t size_ = 0;
  std::set<std::string> foreign_topics_;
  std::string ending_;
};

}  // namespace platoon
