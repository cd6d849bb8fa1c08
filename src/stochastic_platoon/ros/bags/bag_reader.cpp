#include "stochastic_platoon/ros/bags/bag_reader.hpp"

#include <filesystem>

#include "stochastic_platoon/ros/bags/bag_stream.hpp"

namespace platoon {

namespace {

RecordedMessages::Wanted wanted_by(const BagContent& content) {
  return [&content](const PlatoonTopic& topic) -> bool {
    switch (topic.kind) {
      case PlatoonTopic::Kind::position:
        return bool(content.position);
      case PlatoonTopic::Kind::predecessor_position:
        return bool(content.predecessor_position);
      case PlatoonTopic::Kind::error_statistics:
        return bool(content.error_statistics);
      case PlatoonTopic::Kind::configuration:
        return bool(content.configuration);
      case PlatoonTopic::Kind::input:
        return bool(content.input);
      case PlatoonTopic::Kind::predecessor_input:
        return bool(content.predecessor_input);
      case PlatoonTopic::Kind::checksum:
        return false;
    }
    return false;
  };
}

void hand_over(const RecordedMessage& message, const BagContent& content) {
  using stochastic_platoon::ErrorStatistics;
  using stochastic_platoon::Position;
  switch (message.topic.kind) {
    case PlatoonTopic::Kind::position:
      return content.position(message.topic, std::get<Position::Ptr>(message.content));
    case PlatoonTopic::Kind::predecessor_position:
      return content.predecessor_position(message.topic, std::get<Position::Ptr>(message.content));
    case PlatoonTopic::Kind::error_statistics:
      return content.error_statistics(message.topic, std::get<ErrorStatistics::Ptr>(message.content));
    case PlatoonTopic::Kind::configuration:
      return content.configuration(message.topic, std::get<std::string>(message.content));
    case PlatoonTopic::Kind::input:
      return content.input(message.topic, std::get<Position::Ptr>(message.content));
    case PlatoonTopic::Kind::predecessor_input:
      return content.predecessor_input(message.topic, std::get<Position::Ptr>(message.content));
    case PlatoonTopic::Kind::checksum:
      return;
  }
}

}  // namespace

BagRemainder read_bags(const BagSource& source, const BagContent& content) {
  BagStream stream(source, wanted_by(content));
  for (std::uint64_t count = 0; const std::optional<RecordedMessage> message = stream.next(); ++count) {
    hand_over(*message, content);
    if (content.progress && count % 256 == 0) content.progress(stream.position(), stream.size());
  }
  if (content.progress) content.progress(stream.size(), stream.size());
  return {stream.foreign_topics(), stream.ending()};
}

bool read_end_of_bag(const std::string& file, std::size_t chunks, const BagContent& content) {
  RecordedMessages messages(file, {{file}, Accept::damaged, false}, wanted_by(content));
  const bool whole = messages.skip_to_last_chunks(chunks);
  while (const std::optional<RecordedMessage> message = messages.next()) hand_over(*message, content);
  return whole;
}

}  // namespace platoon
