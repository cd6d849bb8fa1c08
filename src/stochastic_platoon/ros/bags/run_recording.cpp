#include "stochastic_platoon/ros/bags/run_recording.hpp"

#include <algorithm>
#include <filesystem>

#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/ros/bags/bag_records.hpp"
#include "stochastic_platoon/ros/bags/bag_statistics.hpp"
#include "stochastic_platoon/ros/bags/bag_stream.hpp"
#include "stochastic_platoon/ros/messages/position.hpp"

namespace platoon {

using stochastic_platoon::ErrorStatistics;
using stochastic_platoon::Position;

namespace {

constexpr char kRecoveredSuffix[] = ".recovered";

bool any_topic(const PlatoonTopic&) {
  return true;
}

// All realizations before the returned one are recorded if `id` is the latest message of a stream.
std::uint64_t whole_before(const BatchSchedule& schedule, const MessageId& id) {
  return schedule.is_last_step(id.step) ? schedule.next(id.first_realization) : id.first_realization;
}

ConfigurationError of_another_run(const std::string& file) {
  return ConfigurationError({"record: " + file + ": is of another run: must be another name, or that file moved away"});
}

}  // namespace

RunRecording::RunRecording(const Configuration& configuration, const std::string& name_space)
    : configuration_(configuration),
      name_space_(name_space),
      topics_(recorded_topics(configuration, name_space)),
      recorded_configuration_{name_space + "/" + kConfigurationTopic, to_json(configuration).dump()},
      part_begin_(configuration.run.first_realization),
      arrivals_(configuration.run.schedule(), topics_.size(), configuration.run.first_realization, 0) {
  for (std::size_t s = 0; s < topics_.size(); ++s) streams_[parse_topic(topics_[s]).value().key()] = s;
  try {
    recover();
    if (!finished_ && !recording_) recording_ = record_to(kActiveSuffix);
  } catch (...) {
    abandon();
    throw;
  }
}

bool is_final(const ErrorStatistics& message, const RunOptions& run) {
  return message.realizations == run.realizations && message.step + 1 == run.steps;
}

std::vector<std::string> recorded_topics(const Configuration& configuration, const std::string& name_space) {
  const std::size_t followers = configuration.run.followers;
  std::vector<std::string> topics;
  const auto add = [&](const std::string& topic) { topics.push_back(name_space + "/" + topic); };
  const auto add_received = [&](std::size_t i, bool predecessor_position) {
    const VehicleModel& own = vehicle(configuration.model, i);
    for (std::size_t n = 0; n < own.inputs.size(); ++n) {
      const std::string topic = received_topic(own, i, n);
      if ((topic == predecessor_position_topic(i)) == predecessor_position) add(topic);
    }
  };
  for (std::size_t i = 0; i <= followers; ++i) add(position_topic(i));
  for (std::size_t i = 1; i <= followers; ++i) add_received(i, true);
  for (std::size_t i = 0; i < followers; ++i) {
    if (sends_input(configuration.model, i, followers)) add(input_topic(i));
    add_received(i + 1, false);
  }
  for (const std::size_t i : measured_followers(configuration)) {
    if (!sends_input(configuration.model, i, followers)) add(input_topic(i));
  }
  return topics;
}

std::string RunRecording::name_of_part(std::size_t part) const {
  const std::string& name = configuration_.run.record;
  if (configuration_.run.record_split_mb == 0) return name;
  return name.substr(0, name.size() - 4) + "_" + std::to_string(part) + ".bag";
}

std::string RunRecording::next_put_aside() const {
  return name_put_aside(name_of_part(part_), put_aside_.size() + 1);
}

std::unique_ptr<BagWriter> RunRecording::record_to(const std::string& suffix) const {
  return std::make_unique<BagWriter>(name_of_part(part_), suffix, configuration_.run.record_compression,
                                     recorded_configuration_);
}

DropReason RunRecording::receive(std::size_t stream, const Message& message) {
  const MessageDescriptor descriptor = descriptor_of(*message);
  const bool is_newer = descriptor.id.attempt > arrivals_.attempt();
  const DropReason drop = arrivals_.admit(stream, descriptor);
  if (drop != DropReason::none) return drop;
  if (is_newer) restarted();
  take(stream, message);
  const std::optional<CompleteBatch> batch = arrivals_.count(stream, descriptor);
  if (batch) batch_complete();
  return drop;
}

void RunRecording::take(std::size_t stream, const Message& message) {
  if (!recording_ || message->first_realization < arrivals_.committed()) return;  // recorded already
  const std::pair<std::uint64_t, std::int64_t> key{message->first_realization, message->step};
  Step& step = open_[key];
  step.messages.resize(topics_.size());
  step.messages[stream] = message;
  if (++step.arrived < step.messages.size()) return;
  for (std::size_t s = 0; s < step.messages.size(); ++s) recording_->write(topics_[s], *step.messages[s]);
  recording_->end_step(configuration_.run.schedule().is_last_step(message->step));
  open_.erase(key);
  partial_ = true;
}

// None if the topic is no stream of this recording.
std::optional<std::size_t> RunRecording::stream_of(const PlatoonTopic& topic) const {
  const auto stream = streams_.find(topic.key());
  return stream != streams_.end() ? std::make_optional(stream->second) : std::nullopt;
}

void RunRecording::restarted() {
  open_.clear();
  if (!partial_) return;
  partial_ = false;
  holds_abandoned_ = true;  // rewritten without it when the file is complete: now it would block the run
}

void RunRecording::batch_complete() {
  partial_ = false;
  const auto split_bytes = static_cast<std::uint64_t>(configuration_.run.record_split_mb) << 20;
  if (!recording_ || split_bytes == 0 || recording_->bytes() < split_bytes || !complete_file()) return;
  ++part_;
  if (const std::string left = left_recording(name_of_part(part_)); !left.empty()) throw of_another_run(left);
  part_begin_ = arrivals_.committed();
  recording_ = record_to(kActiveSuffix);
}

void RunRecording::receive(const ErrorStatistics& message) {
  if (finished_ || message.header.stamp.isZero()) return;
  if (arrivals_.attempt() == 0 && !is_final(message, configuration_.run)) return;
  if (recording_) recording_->write(name_space_ + "/" + kErrorStatisticsTopic, message);
  if (is_final(message, configuration_.run)) final_statistics_ = true;
}

void RunRecording::finish() {
  if (!complete_file()) return;
  recording_.reset();
  finished_ = true;
}

// Returns whether the file is complete: false if rewriting it has shown that batches are lost.
bool RunRecording::complete_file() {
  const std::uint64_t committed = arrivals_.committed();
  if (needs_rewriting()) rewrite();
  if (arrivals_.committed() < committed) return false;
  if (std::filesystem::exists(name_of_part(part_))) throw of_another_run(name_of_part(part_));
  recording_->complete();
  completed_bytes_ += recording_->bytes();
  return true;
}

void RunRecording::abandon() noexcept {
  if (recording_) recording_->abandon();
  std::error_code ignored;  // the unfinished copy of rewrite(), if any
  std::filesystem::remove(name_of_part(part_) + kRecoveredSuffix, ignored);
}

void RunRecording::stop() {
  if (finished_) return;
  const bool is_empty = put_aside_.empty() && !partial_ && !holds_abandoned_ && arrivals_.committed() == part_begin_;
  if (!put_aside_.empty()) rewrite();
  recording_->close();
  // Without a step, the file would do nothing but block its name.
  if (is_empty) std::filesystem::remove(name_of_part(part_) + kActiveSuffix);
}

// Takes over the files of a killed recorder of the same launch.
void RunRecording::recover() {
  while (std::filesystem::exists(name_of_part(part_))) {
    if (launch_of(name_of_part(part_)) != configuration_.run.launch_id) throw of_another_run(name_of_part(part_));
    if (configuration_.run.record_split_mb == 0) {
      arrivals_.resume_at(configuration_.run.realizations);
      finished_ = true;
      return;
    }
    ++part_;
  }
  if (part_ > 0) take_over(name_of_part(part_ - 1));
  part_begin_ = arrivals_.committed();
  while (std::filesystem::exists(next_put_aside())) {
    put_aside_.push_back(next_put_aside());
    take_over(put_aside_.back());
  }
  const std::string active = name_of_part(part_) + kActiveSuffix;
  if (!std::filesystem::exists(active)) {
    finished_ = part_ > 0 && put_aside_.empty() && arrivals_.complete();
    return;
  }
  // A file without new batches is overwritten: a full disk leaves one at every retry.
  if (!take_over(active)) return;
  put_aside_.push_back(next_put_aside());
  std::filesystem::rename(active, put_aside_.back());
}

// Throws ConfigurationError unless the configuration in an unfinished file is of this launch.
void RunRecording::require_same_launch(const std::string& file, const std::string& configuration) const {
  if (parse_configuration(configuration).run.launch_id != configuration_.run.launch_id) throw of_another_run(file);
}

// Finds the last whole batch of a file from the latest message of each stream: steps are written in their order, and
// whole batches are not recorded again. Returns whether the file adds anything to the files before it.
bool RunRecording::take_over(const std::string& file) {
  if (ends_in_first_line(file)) return false;  // its recorder was killed there, or found no space
  const BatchSchedule schedule = configuration_.run.schedule();
  std::vector<std::optional<MessageId>> latest(topics_.size());
  const auto misses_a_stream = [&latest] {
    return std::any_of(latest.begin(), latest.end(), [](const auto& id) { return !id; });
  };
  bool whole = false;
  for (std::size_t chunks = 1; !whole && misses_a_stream(); chunks *= 4) {
    RecordedMessages end(file, {{file}, Accept::damaged}, any_topic);
    whole = end.skip_to_last_chunks(chunks);
    while (const std::optional<RecordedMessage> message = end.next()) {
      if (const std::optional<std::size_t> stream = stream_of(message->topic)) {
        latest[*stream] = id_of(*message->position());
      } else if (message->topic.kind == PlatoonTopic::Kind::error_statistics) {
        receive(*std::get<ErrorStatistics::Ptr>(message->content));
      } else if (message->topic.kind == PlatoonTopic::Kind::configuration) {
        require_same_launch(file, std::get<std::string>(message->content));
      }
    }
  }
  std::uint64_t committed = configuration_.run.realizations;
  std::uint32_t attempt = arrivals_.attempt();
  for (const std::optional<MessageId>& id : latest) {
    committed = std::min(committed, id ? whole_before(schedule, *id) : 0);
    if (id) attempt = std::max(attempt, id->attempt);
  }
  const bool adds = schedule.endless() ? latest.front().has_value() : committed > arrivals_.committed();
  // Incomplete batches are not taken over: the leader must repeat them.
  arrivals_ = Arrivals(schedule, topics_.size(), std::max(committed, arrivals_.committed()), attempt);
  return adds;
}

// Replaces the unfinished files of this part by a copy of their whole batches.
void RunRecording::rewrite() {
  const BatchSchedule schedule = configuration_.run.schedule();
  const std::string active = name_of_part(part_) + kActiveSuffix;
  recording_->close();
  std::vector<std::string> files = put_aside_;
  files.push_back(active);

  // A batch is complete in its latest recorded attempt. In an endless run all attempts count.
  std::map<std::uint64_t, std::uint32_t> last_attempt;  // by first realization
  for (const std::string& file : files) {
    if (schedule.endless()) break;
    BagStream positions({{file}, Accept::damaged},
                        [](const PlatoonTopic& topic) { return topic.kind == PlatoonTopic::Kind::position; });
    while (const std::optional<RecordedMessage> message = positions.next()) {
      std::uint32_t& attempt = last_attempt[message->position()->first_realization];
      attempt = std::max(attempt, message->position()->attempt);
    }
  }

  recording_ = record_to(kRecoveredSuffix);
  Arrivals copied(schedule, topics_.size(), part_begin_, 0);
  const auto copy = [&](std::size_t stream, const Position& message) {
    if (!schedule.endless() && last_attempt[message.first_realization] != message.attempt) return;
    const MessageDescriptor descriptor = descriptor_of(message);
    if (copied.admit(stream, descriptor) != DropReason::none) return;
    recording_->write(topics_[stream], message);
    if (stream + 1 == topics_.size()) recording_->end_step(schedule.is_last_step(message.step));
    copied.count(stream, descriptor);
  };
  for (const std::string& file : files) {
    BagStream messages({{file}, Accept::damaged}, any_topic);
    while (const std::optional<RecordedMessage> message = messages.next()) {
      if (const std::optional<std::size_t> stream = stream_of(message->topic)) {
        copy(*stream, *message->position());
      } else if (message->topic.kind == PlatoonTopic::Kind::error_statistics) {
        recording_->write(name_space_ + "/" + kErrorStatisticsTopic, *std::get<ErrorStatistics::Ptr>(message->content));
      }
    }
  }

  // Crash-safe order: duplicates are possible, loss and gaps in the file numbers are not.
  recording_->set_suffix(kActiveSuffix);
  for (; !put_aside_.empty(); put_aside_.pop_back()) std::filesystem::remove(put_aside_.back());
  holds_abandoned_ = copied.committed() < arrivals_.committed();
  if (!holds_abandoned_) return;
  arrivals_ = Arrivals(schedule, topics_.size(), copied.committed(), arrivals_.attempt());
  open_.clear();
}

}  // namespace platoon
