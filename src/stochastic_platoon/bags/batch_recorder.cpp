#include "stochastic_platoon/bags/batch_recorder.hpp"

#include <algorithm>
#include <filesystem>
#include <tuple>

#include "stochastic_platoon/bags/bag_reader.hpp"

namespace platoon {

using stochastic_platoon::ErrorStatistics;

namespace {

constexpr char kRecoveredSuffix[] = ".recovered";

bool is_of_launch(const std::string& configuration_text, const std::string& launch) {
  return parse_configuration(YAML::Load(configuration_text)).run.launch == launch;
}

}  // namespace

BatchRecorder::BatchRecorder(const Configuration& configuration, const std::string& name_space)
    : configuration_(configuration),
      name_space_(name_space),
      options_{configuration.run.record, static_cast<std::uint64_t>(configuration.run.record_split_mb) << 20,
               configuration.run.record_compression},
      configuration_text_(to_json(configuration).dump()),
      arrivals_(configuration.run.schedule(), 2 * configuration.run.followers + 1,
                configuration.run.first_realization, 0,
                {[this] { open_.clear(); },
                 [this](const CompleteBatch& batch) { write_batch(batch.first_realization); }}) {
  recover();
  if (!finished_ && !recording_) recording_ = record_to(kActiveSuffix);
}

std::string BatchRecorder::topic(std::size_t stream) const {
  const std::size_t followers = configuration_.run.followers;
  const std::string vehicle = std::to_string(stream > followers ? stream - followers : stream);
  return name_space_ + "/vehicle_" + vehicle + (stream > followers ? "/predecessor_position" : "/position");
}

std::unique_ptr<Recording> BatchRecorder::record_to(const std::string& suffix) const {
  return std::make_unique<Recording>(options_, name_space_ + "/configuration", configuration_text_, part_,
                                     suffix);
}

Verdict BatchRecorder::receive(std::size_t stream, const Message& message) {
  const Turn turn{message->attempt, message->first_realization, message->step};
  return arrivals_.receive(stream, turn, message->position, [&] { take(stream, message); });
}

void BatchRecorder::take(std::size_t stream, const Message& message) {
  if (configuration_.run.steps == 0) return recording_->write(topic(stream), *message);
  if (message->first_realization < arrivals_.committed()) return;  // recorded already
  open_[message->first_realization].push_back({stream, message});
}

// In a thread of its own, so that the next batch arrives meanwhile. There is one at a time, and nothing else
// touches the recording before it has ended.
void BatchRecorder::write_batch(std::uint64_t first_realization) {
  wait_for_writing();
  std::vector<Kept> batch = std::move(open_[first_realization]);
  open_.erase(first_realization);
  writing_ = std::async(std::launch::async, [this, kept = std::move(batch)]() mutable {
    std::stable_sort(kept.begin(), kept.end(), [](const Kept& left, const Kept& right) {
      return std::make_tuple(left.message->step, left.stream) <
             std::make_tuple(right.message->step, right.stream);
    });
    for (Kept& each : kept) {
      recording_->write(topic(each.stream), *each.message);
      each.message.reset();
    }
    recording_->between_batches();
  });
}

void BatchRecorder::wait_for_writing() {
  if (writing_.valid()) writing_.get();
  bytes_ = recording_ ? recording_->bytes() : 0;
}

void BatchRecorder::receive(const ErrorStatistics& message) {
  if (finished_ || message.header.stamp.isZero()) return;
  wait_for_writing();
  recording_->write(name_space_ + "/error_statistics", message);
  if (message.realizations == configuration_.run.realizations &&
      message.step + 1 == configuration_.run.steps) {
    final_statistics_ = true;
  }
}

bool BatchRecorder::finish() {
  if (finished_ || !arrivals_.complete() || !final_statistics_) return finished_;
  wait_for_writing();
  recording_->complete();
  bytes_ = recording_->bytes();
  finished_ = true;
  return true;
}

void BatchRecorder::stop() {
  wait_for_writing();
  if (!finished_) recording_->close();
}

// What a killed recorder of the same launch has left behind.
void BatchRecorder::recover() {
  while (std::filesystem::exists(part_name(options_, part_))) {
    if (options_.split_bytes == 0) {
      finished_ = true;
      return;
    }
    ++part_;
  }
  const std::string active = part_name(options_, part_) + kActiveSuffix;
  if (part_ > 0) {
    arrivals_.resume_at(end_of_part(part_ - 1));
    if (arrivals_.complete() && !std::filesystem::exists(active)) {
      finished_ = true;
      return;
    }
  }
  if (std::filesystem::exists(active)) take_over(active);
}

std::uint64_t BatchRecorder::end_of_part(std::size_t part) const {
  std::uint64_t end = 0;
  BagContent content;
  content.position = [&end](const PlatoonTopic&, const Message& message) {
    end = std::max<std::uint64_t>(end, message->first_realization + message->position.size());
  };
  read_bags({part_name(options_, part)}, content);
  return end;
}

void BatchRecorder::take_over(const std::string& file) {
  recording_ = record_to(kRecoveredSuffix);
  bool of_this_launch = false;
  BagContent content;
  content.configuration = [&](const PlatoonTopic&, const std::string& text) {
    of_this_launch = is_of_launch(text, configuration_.run.launch);
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
  wait_for_writing();
  open_.clear();
  std::filesystem::remove(file);
  recording_->set_suffix(kActiveSuffix);
}

}  // namespace platoon
