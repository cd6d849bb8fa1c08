#pragma once

#include <stochastic_platoon/Checksum.h>
#include <stochastic_platoon/ErrorStatistics.h>
#include <stochastic_platoon/Position.h>

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <variant>

#include "stochastic_platoon/ros/bags/bag_walk.hpp"
#include "stochastic_platoon/ros/messages/topics.hpp"

namespace platoon {

/// One recorded message, owned by the reader: a configuration as JSON, a position or error statistics.
struct RecordedMessage {
  PlatoonTopic topic;
  std::variant<std::string, stochastic_platoon::Position::Ptr, stochastic_platoon::ErrorStatistics::Ptr> content;

  /// The message of a topic of positions or inputs. Throws std::bad_variant_access on other topics.
  const stochastic_platoon::Position::Ptr& position() const {
    return std::get<stochastic_platoon::Position::Ptr>(content);
  }
};

/// The messages of a platoon in one bag, in its order. All of them, wanted or not, are verified by their checksums;
/// next() returns a message after the checksum that covers it.
class RecordedMessages {
public:
  using Wanted = std::function<bool(const PlatoonTopic&)>;

  /// Reads `file` as `source` specifies. Throws BagError, as next() does, if `source` does not accept the state of the
  /// file.
  RecordedMessages(const std::string& file, const BagSource& source, Wanted wanted);

  /// The next wanted message; none at the end.
  std::optional<RecordedMessage> next();

  /// Skips to the last `chunks` whole chunks and the records after them; call it before next(). From earlier chunks,
  /// next() returns only the configuration. Returns true if there are no earlier chunks.
  bool skip_to_last_chunks(std::size_t chunks);

  /// Skipped topics, of other names or types.
  const std::set<std::string>& foreign_topics() const { return foreign_topics_; }
  /// Why and where reading ended, if a cut or damaged file was accepted; else empty.
  const std::string& ending() const { return ending_; }

  std::uint64_t position() const { return walk_ ? walk_->position() : 0; }
  std::uint64_t size() const { return walk_ ? walk_->size() : 0; }

private:
  struct Reading {
    std::optional<PlatoonTopic> topic;  ///< none: foreign
    bool wanted = false;
    std::uint64_t digest = 0;  ///< of the topic
  };
  template <typename Read>
  auto guarded(const Read& read) -> decltype(read());
  void take(const RawMessage& message);
  void verify(const stochastic_platoon::Checksum& checksum);
  void begin_checksum();
  const Reading& reading_of(const RawMessage& message);
  void require_checksums() const;
  std::string place() const;

  std::string file_;
  BagSource source_;
  Wanted wanted_;
  std::unique_ptr<BagWalk> walk_;
  std::map<std::uint32_t, Reading> readings_;  ///< by connection
  std::deque<RecordedMessage> ready_;
  std::deque<RecordedMessage> uncovered_;  ///< wanted messages since the latest checksum
  stochastic_platoon::Checksum since_;     ///< the expected next checksum
  std::uint64_t uncovered_messages_ = 0;
  std::uint64_t uncovered_bytes_ = 0;
  bool synchronized_ = true;  ///< all messages since the latest checksum were read
  bool has_checksums_ = false;
  std::set<std::string> foreign_topics_;
  std::string ending_;
};

}  // namespace platoon
