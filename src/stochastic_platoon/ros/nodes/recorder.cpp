#include "stochastic_platoon/ros/nodes/recorder.hpp"

#include <ros/console.h>

#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/ros/messages/position.hpp"
#include "stochastic_platoon/ros/messages/topics.hpp"
#include "stochastic_platoon/run/delivery/vehicle_contract.hpp"
#include "stochastic_platoon/run/io/atomic_file.hpp"

namespace platoon {

using stochastic_platoon::ErrorStatistics;
using stochastic_platoon::Position;

namespace {

// Bytes written that prove success: more than a file's own buffers hold.
constexpr std::uint64_t kBytesOfSuccess = 2u << 20;

// [s] that the first report waits for the publisher of an input while all other topics have theirs.
constexpr double kLateInput = 1.0;

std::string parent_of(const std::string& name) {
  return name.substr(0, name.rfind('/'));
}

}  // namespace

// Runs `work`; a write error abandons the recording and starts a pause.
template <typename Work>
void Recorder::write(const Work& work) {
  try {
    work();
  } catch (const ConfigurationError&) {
    throw;
  } catch (const std::runtime_error& error) {
    write_error_ = configuration_.run.record + ": cannot be written: " + error.what() + "; " +
                   free_space(configuration_.run.record);
    if (!pause_.is_on()) ROS_ERROR_STREAM(write_error_ << ". The platoon waits, and continues when there is space");
    if (recording_) {
      reported_ = recording_->arrivals();
      recording_->abandon();
      recording_.reset();
    }
    pause_.failed(now());
  }
}

Recorder::Recorder(ros::NodeHandle platoon, const Configuration& configuration, RunMembership::Join superseded)
    : configuration_(configuration),
      membership_(platoon, "recorder", run_identity(configuration), std::move(superseded)),
      name_space_(parent_of(platoon.resolveName(kConfigurationTopic))),
      topics_(recorded_topics(configuration, name_space_)),
      reported_(configuration.run.schedule(), topics_.size(), configuration.run.first_realization, 0),
      reports_(platoon, "recorder", configuration) {
  ignore_file_size_signal();
  begin();
  inputs_.reserve(topics_.size());
  for (std::size_t s = 0; s < topics_.size(); ++s) {
    inputs_.emplace_back(membership_, platoon, topics_[s]);
    inputs_.back().subscribe([this, s](const PositionEvent& event) { receive(s, event); });
  }
  error_statistics_ =
      platoon.subscribe(kErrorStatisticsTopic, kUnboundedQueue, &Recorder::receive_statistics, this, no_delay());
  // After change_run, the leader publishes no position before the recorder's first report, so progress must reveal the
  // new run.
  progress_ = platoon.subscribe<stochastic_platoon::Progress>(
      kProgressTopic, kUnboundedQueue,
      [this](const stochastic_platoon::Progress::ConstPtr& message) { membership_.admits(message->run); });
  timer_ = platoon.createSteadyTimer(ros::WallDuration(kHeartbeat), [this](const auto&) { tick(); });
}

void Recorder::begin() {
  write([this] {
    recording_.emplace(configuration_, name_space_);
    tried_at_ = recording_->bytes();
    if (recording_->finished()) return reports_.set_finished();
    if (!final_statistics_) return;
    recording_->receive(*final_statistics_);  // the monitor publishes them once
    finish();
  });
}

VitalSigns::Sources Recorder::sources() const {
  VitalSigns::Sources all;
  for (const PositionInput& input : inputs_) all.push_back(&input.counter());
  return all;
}

void Recorder::stop() {
  if (recording_) write([this] { recording_->stop(); });
}

void Recorder::receive(std::size_t stream, const PositionEvent& event) {
  const Position::ConstPtr message = event.getMessage();
  if (message->header.stamp.isZero()) {
    ROS_WARN_STREAM_THROTTLE(1.0, topics_[stream] << ": dropped a message without a stamp, which a bag cannot hold; "
                                                  << named(Clause::stamp));
    return;
  }
  reports_.saw(message->header.stamp.toNSec());
  if (!recording_) return;
  write([&] {
    const DropReason drop = recording_->receive(stream, message);
    if (!inputs_[stream].takes(drop, id_of(*message), message->position.size())) return;
    if (!began_) began_ = now();
    if (pause_.is_on() && recording_->bytes() > tried_at_ + kBytesOfSuccess) {
      ROS_WARN_STREAM(configuration_.run.record << ": is recorded again");
      pause_.succeeded();
    }
    reports_.report_if_due(recording_->arrivals());
    finish();
  });
}

void Recorder::receive_statistics(const ErrorStatistics::ConstPtr& message) {
  if (is_final(*message, configuration_.run)) final_statistics_ = message;
  if (!recording_) return;
  write([&] {
    recording_->receive(*message);
    finish();
  });
}

void Recorder::finish() {
  if (!recording_->ready_to_finish()) return;
  if (recording_->needs_rewriting()) ROS_INFO("writing the bag once more, without the abandoned attempts");
  recording_->finish();
  if (!recording_->finished()) {
    ROS_WARN_STREAM(configuration_.run.record << ": a part of the recording is unreadable: recording again from there");
    return report();
  }
  pause_.succeeded();
  ROS_INFO_STREAM("recorded " << recording_->bytes() / 1000000 << " MB");
  reports_.set_finished();
  report();
}

void Recorder::tick() {
  if (!recording_ && pause_.is_due(now())) begin();
  std::optional<std::string> awaited;
  const auto connected = [&] { return !(awaited = awaited_topic()); };
  if ((recording_ && recording_->finished()) || reports_.is_linked(connected)) return report();
  reports_.set_blocked("no publisher of " + *awaited);
  reports_.report(recording_ ? recording_->arrivals() : reported_);
}

// A topic without a publisher for which the first report waits.
std::optional<std::string> Recorder::awaited_topic() {
  std::optional<std::string> input;
  for (std::size_t s = 0; s < topics_.size(); ++s) {
    if (inputs_[s].is_connected()) continue;
    if (parse_topic(topics_[s])->kind != PlatoonTopic::Kind::input) return topics_[s];
    if (!input) input = topics_[s];
  }
  if (error_statistics_.getNumPublishers() == 0) return error_statistics_.getTopic();
  if (!heard_) heard_ = now();
  return now() - *heard_ < kLateInput ? input : std::nullopt;
}

// Without a recording the latest report is repeated. The first report of a new recording is then lower, and the leader
// repeats the batch at once.
void Recorder::report() {
  if (!recording_) {
    reports_.set_blocked(write_error_);
    return reports_.report(reported_);
  }
  const double megabytes = static_cast<double>(recording_->bytes()) * 1e-6;
  const double seconds = began_ ? now() - *began_ : 0.0;
  reports_.set_note(formatted("bag %.0f MB, %.0f MB/s", megabytes, seconds > 0.0 ? megabytes / seconds : 0.0));
  reports_.report(recording_->arrivals());
}

}  // namespace platoon
