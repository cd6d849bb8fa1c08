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

}  // namespace

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
}

std::optional<RecordedMessage> BagStream::next() {
  while (present_ || !files_.empty()) {
    if (!present_) {
      present_ = std::make_unique<RecordedMessages>(files_.back(), source_, wanted_);
      files_.pop_back();
    }
    if (std::optional<RecordedMessage> message = present_->next()) return message;
    before_ += present_->size();
    foreign_topics_.insert(present_->foreign_topics().begin(), present_->foreign_topics().end());
    if (ending_.empty()) ending_ = present_->ending();
    present_.reset();
  }
  return std::nullopt;
}

}  // namespace platoon
