#include "stochastic_platoon/ros/bags/bag_stream.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>

namespace platoon {

namespace {

// Recorded time of the first position [ns]; 0 if none can be read, which is reported when the file is read.
std::uint64_t begin_of(const std::string& file) {
  try {
    BagWalk walk(file);
    while (const std::optional<RawMessage> message = walk.next()) {
      const std::optional<PlatoonTopic> topic = parse_topic(walk.connection(*message).topic);
      if (topic && topic->kind == PlatoonTopic::Kind::position) return message->time;
    }
  } catch (const BagCut&) {
  } catch (const BagDamage&) {
  }
  return 0;
}

// The configuration with which a file begins; none if a position comes first, as in a later part of `rosbag record`.
std::optional<RecordedMessage> first_configuration(const std::string& file, const BagSource& source) {
  RecordedMessages messages(file, source, [](const PlatoonTopic& topic) {
    return is_configuration(topic) || topic.kind == PlatoonTopic::Kind::position;
  });
  std::optional<RecordedMessage> first = messages.next();
  if (first && !is_configuration(first->topic)) first.reset();
  return first;
}

}  // namespace

bool is_configuration(const PlatoonTopic& topic) {
  return topic.kind == PlatoonTopic::Kind::configuration;
}

BagStream::BagStream(const BagSource& source, RecordedMessages::Wanted wanted)
    : source_(source), wanted_(std::move(wanted)) {
  std::vector<std::pair<std::uint64_t, std::string>> files;
  for (const std::string& file : source.files) {
    files.emplace_back(source.files.size() > 1 ? begin_of(file) : 0, file);
    std::error_code ignored;
    const std::uintmax_t bytes = std::filesystem::file_size(file, ignored);
    if (!ignored) size_ += bytes;
  }
  std::sort(files.rbegin(), files.rend());
  for (const auto& file : files) files_.push_back(file.second);
  if (files_.size() == 1) return;
  for (auto file = files_.rbegin(); file != files_.rend(); ++file) {
    if (const auto configuration = first_configuration(*file, source_)) require_one_run(*configuration);
  }
}

void BagStream::require_one_run(const RecordedMessage& configuration) {
  if (!configuration_) configuration_ = configuration;
  // A latched message may be repeated.
  if (configuration.content == configuration_->content &&
      configuration.topic.name_space == configuration_->topic.name_space)
    return;
  throw BagError(source_.files.front() + ": holds more than one run of a platoon: must hold one");
}

std::optional<RecordedMessage> BagStream::next() {
  while (present_ || !files_.empty()) {
    if (!present_) {
      present_ = std::make_unique<RecordedMessages>(
          files_.back(), source_,
          [wanted = wanted_](const PlatoonTopic& topic) { return is_configuration(topic) || wanted(topic); });
      files_.pop_back();
    }
    while (std::optional<RecordedMessage> message = present_->next()) {
      if (!is_configuration(message->topic)) return message;
      require_one_run(*message);
      if (wanted_(message->topic)) return message;
    }
    before_ += present_->size();
    foreign_topics_.insert(present_->foreign_topics().begin(), present_->foreign_topics().end());
    if (ending_.empty()) ending_ = present_->ending();
    present_.reset();
  }
  return std::nullopt;
}

}  // namespace platoon
