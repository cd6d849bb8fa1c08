#include "stochastic_platoon/bags/run_recording.hpp"

#include <algorithm>
#include <filesystem>

#include "stochastic_platoon/bags/bag_reader.hpp"
#include "stochastic_platoon/messages/position.hpp"

namespace platoon {

using stochastic_platoon::ErrorStatistics;
using stochastic_platoon::Position;

namespace {

constexpr char kRecoveredSuffix[] = ".recovered";

bool is_of_launch(const std::string& configuration_text, const std::string& launch_id) {
  return parse_configuration(configuration_text).run.launch_id == launch_id;
}

}  // namespace

RunRecording::RunRecording(const Configuration& configuration, const std::string& name_space)
    : configuration_(configuration),
      name_space_(name_space),
      recorded_configuration_{name_space + "/configuration", to_json(configuration).dump()},
      arrivals_(configuration.run.schedule(), streams(), configuration.run.first_realization, 0) {
  try {
    recover();
    if (!finished_ && !recording_) recording_ = record_to(kActiveSuffix);
  } catch (...) {
    abandon();
    throw;
  }
}

std::string topic_of_stream(std::size_t stream, const RunOptions& run, const std::string& name_space) {
  return name_space + "/" +
         (stream > run.followers ? predecessor_position_topic(stream - run.followers)
                                 : position_topic(stream));
}

std::string RunRecording::name_of_part(std::size_t part) const {
  const std::string& name = configuration_.run.record;
  if (configuration_.run.record_split_mb == 0) return name;
  return name.substr(0, name.size() - 4) + "_" + std::to_string(part) + ".bag";
}

std::unique_ptr<BagWriter> RunRecording::record_to(const std::string& suffix) const {
  return std::make_unique<BagWriter>(name_of_part(part_), suffix, configuration_.run.record_compression,
                                     recorded_configuration_);
}

Verdict RunRecording::receive(std::size_t stream, const Message& message) {
  const Heading heading = heading_of(*message);
  const Arrivals::Admission admission = arrivals_.admit(stream, heading);
  if (admission.verdict != Verdict::in_turn) return admission.verdict;
  if (admission.restarted) restarted();
  take(stream, message);
  const std::optional<CompleteBatch> batch = arrivals_.count(stream, heading);
  if (batch) batch_complete(batch->first_realization);
  return admission.verdict;
}

void RunRecording::take(std::size_t stream, const Message& message) {
  if (!recording_ || message->first_realization < arrivals_.committed()) return;  // recorded already
  const std::pair<std::uint64_t, std::int64_t> key{message->first_realization, message->step};
  Step& step = open_[key];
  step.messages.resize(streams());
  step.messages[stream] = message;
  if (++step.arrived < step.messages.size()) return;
  for (std::size_t s = 0; s < step.messages.size(); ++s) recording_->write(topic(s), *step.messages[s]);
  open_.erase(key);
  partial_ = true;
}

void RunRecording::restarted() {
  open_.clear();
  if (!partial_) return;
  partial_ = false;
  given_up_ = true;  // written again without it when the file is complete: now the run would wait
}

void RunRecording::batch_complete(std::uint64_t first_realization) {
  const std::uint32_t attempt = arrivals_.attempt();
  if (whole_.empty() || whole_.back().attempt != attempt)
    whole_.push_back({attempt, first_realization, first_realization});
  whole_.back().end = arrivals_.committed();
  partial_ = false;
  const auto split_bytes = static_cast<std::uint64_t>(configuration_.run.record_split_mb) << 20;
  if (!recording_ || split_bytes == 0 || recording_->bytes() < split_bytes) return;
  complete_file();
  ++part_;
  recording_ = record_to(kActiveSuffix);
}

bool RunRecording::is_whole(const Position& message) const {
  if (configuration_.run.averaging() == Averaging::over_time) return true;
  return std::any_of(whole_.begin(), whole_.end(), [&message](const Whole& whole) {
    return message.attempt == whole.attempt && message.first_realization >= whole.begin &&
           message.first_realization < whole.end;
  });
}

void RunRecording::receive(const ErrorStatistics& message) {
  if (finished_ || message.header.stamp.isZero()) return;
  if (recording_) recording_->write(name_space_ + "/error_statistics", message);
  if (message.realizations == configuration_.run.realizations &&
      message.step + 1 == configuration_.run.steps) {
    final_statistics_ = true;
  }
}

void RunRecording::finish() {
  complete_file();
  recording_.reset();
  finished_ = true;
}

void RunRecording::complete_file() {
  if (given_up_) rewrite();
  recording_->complete();
  completed_bytes_ += recording_->bytes();
}

void RunRecording::abandon() noexcept {
  if (recording_) recording_->abandon();
  std::error_code ignored;  // the copy of rewrite(), if it was that which did not fit
  std::filesystem::remove(name_of_part(part_) + kRecoveredSuffix, ignored);
}

void RunRecording::stop() {
  if (!finished_) recording_->close();
}

// What a killed recorder of the same launch has left behind.
void RunRecording::recover() {
  while (std::filesystem::exists(name_of_part(part_))) {
    if (configuration_.run.record_split_mb == 0) {
      arrivals_.resume_at(configuration_.run.realizations);
      finished_ = true;
      return;
    }
    ++part_;
  }
  const std::string active = name_of_part(part_) + kActiveSuffix;
  if (part_ > 0) {
    arrivals_.resume_at(end_of_part(part_ - 1));
    if (arrivals_.complete() && !std::filesystem::exists(active)) {
      finished_ = true;
      return;
    }
  }
  if (std::filesystem::exists(active)) take_over(active);
}

std::uint64_t RunRecording::end_of_part(std::size_t part) const {
  std::uint64_t end = 0;
  BagContent content;
  content.position = [&end](const PlatoonTopic&, const Message& message) {
    end = std::max<std::uint64_t>(end, message->first_realization + message->position.size());
  };
  read_bags({name_of_part(part)}, content);
  return end;
}

// Finds out which batches are whole in a file, and keeps those.
void RunRecording::take_over(const std::string& file) {
  bool of_this_launch = false;
  BagContent content;
  content.configuration = [&](const PlatoonTopic&, const std::string& text) {
    of_this_launch = is_of_launch(text, configuration_.run.launch_id);
    if (of_this_launch) return;
    throw ConfigurationError({"record: " + file +
                              ": is the unfinished recording of another run: must be another name, or that "
                              "file moved away"});
  };
  const std::size_t followers = configuration_.run.followers;
  content.position = [&](const PlatoonTopic& topic, const Message& message) {
    receive(topic.vehicle, message);
  };
  content.predecessor_position = [&](const PlatoonTopic& topic, const Message& message) {
    receive(followers + topic.vehicle, message);
  };
  content.error_statistics = [&](const PlatoonTopic&, const ErrorStatistics::ConstPtr& message) {
    receive(*message);
  };
  read_damaged_bag(file, content);
  rewrite();
  // Of what is not whole nothing is taken over: the leader is to begin again.
  arrivals_ = Arrivals(configuration_.run.schedule(), streams(), arrivals_.committed(), arrivals_.attempt());
  open_.clear();
  partial_ = false;
}

// Copies what is whole in the unfinished file, and puts the copy in its place.
void RunRecording::rewrite() {
  const std::string file = name_of_part(part_) + kActiveSuffix;
  if (recording_) recording_->close();
  recording_ = record_to(kRecoveredSuffix);
  BagContent content;
  content.position = [&](const PlatoonTopic& topic, const Message& message) {
    if (is_whole(*message)) recording_->write(this->topic(topic.vehicle), *message);
  };
  content.predecessor_position = [&](const PlatoonTopic& topic, const Message& message) {
    if (is_whole(*message))
      recording_->write(this->topic(configuration_.run.followers + topic.vehicle), *message);
  };
  content.error_statistics = [&](const PlatoonTopic&, const ErrorStatistics::ConstPtr& message) {
    recording_->write(name_space_ + "/error_statistics", *message);
  };
  read_damaged_bag(file, content);
  std::filesystem::remove(file);
  recording_->set_suffix(kActiveSuffix);
  given_up_ = false;
}

}  // namespace platoon
