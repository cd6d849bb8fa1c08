#include "stochastic_platoon/ros/bags/recorded_messages.hpp"

#include <ros/message_traits.h>
#include <ros/serialization.h>
#include <std_msgs/String.h>

#include <boost/make_shared.hpp>
#include <utility>

#include "stochastic_platoon/ros/messages/serialized.hpp"
#include "stochastic_platoon/run/io/xxhash64.hpp"

namespace platoon {

using stochastic_platoon::Checksum;
using stochastic_platoon::ErrorStatistics;
using stochastic_platoon::Position;

namespace {

// Bytes between two checksums, at most: 2^24 and the longest message.
constexpr std::uint64_t kMostUncovered = (1u << 24) + kLongestChunk;

template <typename Message>
bool is(const BagConnection& connection) {
  return connection.type == ros::message_traits::datatype<Message>() &&
         connection.md5sum == ros::message_traits::md5sum<Message>();
}

bool has_the_type_of(const PlatoonTopic& topic, const BagConnection& connection) {
  using Kind = PlatoonTopic::Kind;
  if (topic.kind == Kind::configuration) return is<std_msgs::String>(connection);
  if (topic.kind == Kind::error_statistics) return is<ErrorStatistics>(connection);
  if (topic.kind == Kind::checksum) return is<Checksum>(connection);
  return is<Position>(connection);
}

template <typename Message>
boost::shared_ptr<Message> parsed(std::string_view bytes) {
  if (!holds_its_arrays(ros::message_traits::datatype<Message>(), bytes)) throw BagDamage("a message is cut off");
  auto message = boost::make_shared<Message>();
  // IStream only reads, although it takes a non-const pointer.
  ros::serialization::IStream stream(const_cast<std::uint8_t*>(reinterpret_cast<const std::uint8_t*>(bytes.data())),
                                     static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::deserialize(stream, *message);
  return message;
}

RecordedMessage recorded(const PlatoonTopic& topic, std::string_view bytes) {
  using Kind = PlatoonTopic::Kind;
  if (topic.kind == Kind::configuration) return {topic, parsed<std_msgs::String>(bytes)->data};
  if (topic.kind == Kind::error_statistics) return {topic, parsed<ErrorStatistics>(bytes)};
  return {topic, parsed<Position>(bytes)};
}

}  // namespace

RecordedMessages::RecordedMessages(const std::string& file, const BagSource& source, Wanted wanted)
    : file_(file), source_(source), wanted_(std::move(wanted)) {
  guarded([this] {
    walk_ = std::make_unique<BagWalk>(file_);
    return 0;
  });
}

// Calls `read`, unless reading has ended. If the file is cut or damaged, reading ends if the source accepts that;
// otherwise throws BagError.
template <typename Read>
auto RecordedMessages::guarded(const Read& read) -> decltype(read()) {
  if (!ending_.empty()) return {};
  std::string damage;
  try {
    return read();
  } catch (const BagCut& reason) {
    if (!source_.unverified) require_checksums();
    if (source_.accept == Accept::whole) {
      throw BagError(
          file_ + ": was not closed, or its end is missing (" + reason.what() +
          "): its recorder was killed or is still running, or the file was cut off; --partial reads its complete batches");
    }
    ending_ = std::string("ends early, ") + place() + ": " + reason.what();
    return {};
  } catch (const BagDamage& reason) {
    damage = reason.what();
  } catch (const ros::serialization::StreamOverrunException& reason) {
    damage = std::string("a message is cut off: ") + reason.what();
  }
  if (source_.accept != Accept::damaged)
    throw BagError(file_ + ": is damaged, or was changed by another program, " + place() + ": " + damage);
  ending_ = "is damaged, " + place() + ": " + damage;
  return {};
}

std::string RecordedMessages::place() const {
  return "before byte " + std::to_string(position()) + (walk_ ? " of " + std::to_string(size()) : "");
}

bool RecordedMessages::skip_to_last_chunks(std::size_t chunks) {
  return guarded([&] { return walk_->skip_to_last_chunks(chunks); }) == 0;
}

std::optional<RecordedMessage> RecordedMessages::next() {
  while (ready_.empty()) {
    const bool more = guarded([this] {
      const std::optional<RawMessage> message = walk_->next();
      if (message) {
        take(*message);
      } else if (!source_.unverified && uncovered_messages_ > 0) {
        require_checksums();
        throw BagDamage("its last messages have no checksum");
      }
      return message.has_value();
    });
    if (!more) return std::nullopt;
  }
  RecordedMessage message = std::move(ready_.front());
  ready_.pop_front();
  return message;
}

void RecordedMessages::take(const RawMessage& message) {
  if (message.after_gap) {
    begin_checksum();
    synchronized_ = false;
  }
  const Reading& reading = reading_of(message);
  if (!reading.topic) return;
  if (reading.topic->kind == PlatoonTopic::Kind::checksum) {
    has_checksums_ = true;
    if (!source_.unverified) verify(*parsed<Checksum>(message.bytes));
    return;
  }
  const bool passed_over = message.passed_over && reading.topic->kind != PlatoonTopic::Kind::configuration;
  const bool wanted = reading.wanted && !passed_over;
  if (source_.unverified) {
    if (wanted) ready_.push_back(recorded(*reading.topic, message.bytes));
    return;
  }
  Xxhash64 hash(reading.digest + message.time);  // as msg/Checksum.msg defines
  hash.add(message.bytes.data(), message.bytes.size());
  since_.digest += hash.value();
  ++since_.messages;
  ++uncovered_messages_;
  uncovered_bytes_ += message.bytes.size();
  if (uncovered_bytes_ > kMostUncovered) {
    require_checksums();
    throw BagDamage("a checksum is missing");
  }
  if (wanted) uncovered_.push_back(recorded(*reading.topic, message.bytes));
}

void RecordedMessages::verify(const Checksum& checksum) {
  if (!synchronized_) {
    uncovered_.clear();
    since_.messages = checksum.messages;
  } else if (since_.messages != checksum.messages || since_.digest != checksum.digest) {
    throw BagDamage("messages are not as they were recorded");
  }
  for (RecordedMessage& message : uncovered_) ready_.push_back(std::move(message));
  begin_checksum();
  synchronized_ = true;
}

void RecordedMessages::begin_checksum() {
  uncovered_.clear();
  since_.digest = uncovered_messages_ = uncovered_bytes_ = 0;
}

// The first checksum of a recording follows its first message.
void RecordedMessages::require_checksums() const {
  if (has_checksums_ || uncovered_messages_ < 2) return;
  throw BagError(
      file_ +
      ": holds no checksums, so that a changed bit would not be noticed: rosbag record and versions before 0.2.0 write none; --unverified (replay.launch: unverified:=true) reads it nevertheless");
}

const RecordedMessages::Reading& RecordedMessages::reading_of(const RawMessage& message) {
  const auto known = readings_.find(message.connection);
  if (known != readings_.end()) return known->second;
  const BagConnection& connection = walk_->connection(message);
  Reading reading{parse_topic(connection.topic), false, xxhash64(connection.topic)};
  if (reading.topic && !has_the_type_of(*reading.topic, connection)) reading.topic.reset();
  if (!reading.topic) foreign_topics_.insert(connection.topic);
  reading.wanted = reading.topic && wanted_(*reading.topic);
  return readings_.emplace(message.connection, reading).first->second;
}

}  // namespace platoon
