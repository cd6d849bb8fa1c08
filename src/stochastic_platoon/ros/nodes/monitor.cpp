#include "stochastic_platoon/ros/nodes/monitor.hpp"

#include <ros/console.h>

#include <algorithm>
#include <cstdio>
#include <stdexcept>
#include <utility>

#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/ros/messages/position.hpp"
#include "stochastic_platoon/ros/messages/topics.hpp"
#include "stochastic_platoon/ros/observation/run_parameters.hpp"
#include "stochastic_platoon/ros/transport/publishers.hpp"
#include "stochastic_platoon/run/delivery/vehicle_name.hpp"
#include "stochastic_platoon/run/io/printable.hpp"
#include "stochastic_platoon/run/results/run_report.hpp"

namespace platoon {

using stochastic_platoon::Position;
using stochastic_platoon::Progress;

namespace {

std::vector<std::string> topics_of(const ros::NodeHandle& platoon, const RunOptions& run) {
  std::vector<std::string> topics;
  for (std::size_t i = 0; i <= run.followers; ++i) topics.push_back(platoon.resolveName(position_topic(i)));
  return topics;
}

std::vector<Signal> errors_of(const Configuration& configuration) {
  std::vector<Signal> errors;
  for (std::size_t i = 1; i <= configuration.run.followers; ++i)
    errors.push_back(tracking_error(configuration.model, i));
  return errors;
}

void warn(const std::string& text) {
  ROS_WARN_STREAM(text);
}

void log_error(const std::string& text) {
  ROS_ERROR_STREAM(text);
}

}  // namespace

Monitor::Monitor(ros::NodeHandle platoon, const Configuration& configuration, const NodeOfVehicle& node_of_vehicle,
                 RunMembership::Join superseded)
    : configuration_(configuration),
      store_(configuration, log_error, warn),
      membership_(platoon, "monitor", run_identity(configuration), std::move(superseded)),
      prediction_(predict(configuration)),
      statistics_(configuration, store_.start(warn)),
      reports_(platoon, "monitor", configuration),
      stall_(configuration.run, topics_of(platoon, configuration.run)),
      display_(configuration.run.realizations, "realizations",
               static_cast<double>(configuration.run.followers) * static_cast<double>(configuration.run.steps),
               "vehicle-steps"),
      publisher_(platoon, configuration, prediction_, membership_.run()),
      snapshots_(platoon, kSnapshotTopic, configuration.run.followers + 1, errors_of(configuration),
                 configuration.model.sample_period),
      change_(platoon, configuration, [this](const Configuration& next) { membership_.join(next); }) {
  if (!prediction_.warning.empty()) warn(prediction_.warning);
  snapshots_.set_rate(configuration.run.rate);
  set_run_parameters(platoon, configuration);
  wall_seconds_before_ = statistics_.tally().wall_seconds;
  reports_.saw(statistics_.tally().platoon_time);
  subscribe(platoon, node_of_vehicle);
  timer_ = platoon.createSteadyTimer(ros::WallDuration(kHeartbeat), [this](const auto&) { tick(); });
}

void Monitor::subscribe(ros::NodeHandle platoon, const NodeOfVehicle& node_of_vehicle) {
  const std::size_t followers = configuration_.run.followers;
  inputs_.reserve(followers + 1 + statistics_.measured().size());
  for (std::size_t i = 0; i <= followers; ++i) {
    const std::string external = configuration_.run.is_external(i) ? vehicle_name(i) : "";
    inputs_.emplace_back(membership_, node_of_vehicle(i), position_topic(i), "", external);
    inputs_.back().subscribe([this, i](const PositionEvent& event) { receive(i, event); });
  }
  for (const std::size_t i : statistics_.measured()) {
    const std::size_t stream = inputs_.size();
    inputs_.emplace_back(membership_, node_of_vehicle(i), input_topic(i));
    inputs_.back().subscribe([this, stream](const PositionEvent& event) { receive(stream, event); });
  }
  others_ = platoon.subscribe(kProgressTopic, 100, &Monitor::receive_notice, this);
}

void Monitor::receive(std::size_t stream, const PositionEvent& event) {
  const Position::ConstPtr message = event.getMessage();
  const MessageDescriptor descriptor = descriptor_of(*message);
  SignalAssembly::Receipt receipt;
  {
    const Locked lock(lock_);
    statistics_.saw(message->header.stamp.toNSec());
    reports_.saw(message->header.stamp.toNSec());
    receipt = statistics_.receive(stream, descriptor, positions_of(message));
  }
  if (!inputs_[stream].takes(receipt.drop, descriptor.id, descriptor.size)) return;
  if (snapshots_.wanted() && stream <= configuration_.run.followers) snapshots_.take(stream, *message);
  const std::vector<ReducedSignals> signals = compute(receipt.due);
  const Locked lock(lock_);
  const double present = now();
  const bool committed = statistics_.settle(stream, descriptor, signals);
  stall_.note_arrival(statistics_.arrivals(), present);
  if (!began_ && statistics_.arrivals().acknowledgement().step != kNothingYet) began_ = present;
  if (committed) statistics_.set_wall_seconds(wall_seconds_before_ + (began_ ? present - *began_ : 0.0));
  reports_.report_if_due(statistics_.arrivals());
}

void Monitor::receive_notice(const Progress::ConstPtr& message) {
  if (message->receiver == "monitor" || message->run != membership_.run()) return;
  const std::vector<std::string> receivers = configuration_.run.receivers();
  const bool is_receiver = std::find(receivers.begin(), receivers.end(), message->receiver) != receivers.end();
  if (message->notice == Progress::BLOCKED && !is_receiver) return;
  const Locked lock(lock_);
  stall_.receive(message->receiver, {message->notice, message->attempt, printable(message->note)});
}

void Monitor::tick() {
  const double present = now();
  change_.begin_if_asked();
  if (membership_.is_over()) return;
  bool began, complete, departs;
  std::uint64_t committed;
  std::string recorder;
  {
    const Locked lock(lock_);
    began = began_.has_value();
    if (reports_.is_linked([this] { return missing_vehicles().empty(); })) reports_.report(statistics_.arrivals());
    complete = statistics_.arrivals().complete();
    committed = statistics_.arrivals().committed();
    recorder = stall_.text_of("recorder");
    departs = statistics_.leader_departs();
  }
  if (finished_) return;
  if (complete) return finish();
  check_for_stall(present);
  show_manoeuvre(departs);
  if (!began) return show_start(present);
  display_.set_note(recorder);
  if (endless()) {
    display_.finish();
  } else {
    display_.update(committed, present);
  }
  save_checkpoint_if_due(present);
  publish_statistics_if_due(present);
}

void Monitor::save_checkpoint_if_due(double present) {
  std::optional<Checkpoint> checkpoint;
  {
    const Locked lock(lock_);
    if (store_.is_due(statistics_.tally().positions_received, present)) checkpoint = statistics_.checkpoint();
  }
  if (checkpoint) store_.save(*checkpoint, present);
}

void Monitor::finish() {
  if (!store_.can_write(now())) return;
  std::optional<Checkpoint> checkpoint;
  RunResult result;
  {
    const Locked lock(lock_);
    checkpoint = statistics_.checkpoint();
    result = statistics_.result(true);
  }
  display_.update(result.realizations, now());
  if (!store_.complete(*checkpoint, prediction_, result, now())) return;
  display_.finish();
  publisher_.publish_complete(result);
  std::printf("%sResults: %s/statistics.csv and summary.json\n", report(configuration_, prediction_, result).c_str(),
              configuration_.run.output.c_str());
  std::fflush(stdout);
  finished_ = true;
  const Locked lock(lock_);
  reports_.set_finished();
  reports_.report(statistics_.arrivals());
}

void Monitor::stop() {
  bool complete;
  {
    const Locked lock(lock_);
    complete = statistics_.arrivals().complete();
  }
  // Also if it is stopped before its first tick, as one that is started again just after its run has ended.
  if (complete && !finished_) finish();
  std::optional<Checkpoint> checkpoint;
  RunResult partial;
  {
    const Locked lock(lock_);
    if (finished_ || statistics_.averages().empty()) return;
    if (endless() && began_) statistics_.set_wall_seconds(wall_seconds_before_ + now() - *began_);
    checkpoint = statistics_.checkpoint();
    partial = statistics_.result(false);
  }
  display_.finish();
  const std::string failure = store_.stop(*checkpoint, prediction_, partial);
  std::printf("%s", report(configuration_, prediction_, partial).c_str());
  if (!endless())
    std::printf("Stopped after %llu of %llu realizations. ", static_cast<unsigned long long>(partial.realizations),
                static_cast<unsigned long long>(configuration_.run.realizations));
  std::printf("To continue, launch again with output:=%s resume:=true.\n",
              shell_word(configuration_.run.output).c_str());
  std::fflush(stdout);
  if (!failure.empty()) throw std::runtime_error(failure);
}

// Logs a stall once when it begins, when its reason changes, and once when it ends.
void Monitor::check_for_stall(double present) {
  StallReporter::Change change;
  {
    const Locked lock(lock_);
    change = stall_.look({statistics_.arrivals(), began_.has_value(), [this] { return missing_vehicles(); },
                          [this](std::size_t vehicle) { return inputs_[vehicle].counter().latest_breach(); },
                          [this, present] { return mute_vehicles(present); }},
                         present);
  }
  if (!change.stalled.empty()) ROS_WARN_STREAM("run stalled: " << change.stalled);
  if (!change.moving.empty()) ROS_WARN_STREAM("run continues" << change.moving);
}

std::vector<std::size_t> Monitor::missing_vehicles() const {
  std::vector<std::size_t> missing;
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    if (inputs_[i].is_connected()) continue;
    const std::size_t followers = configuration_.run.followers;
    missing.push_back(i <= followers ? i : statistics_.measured()[i - followers - 1]);
  }
  return missing;
}

// Asks the master, at most once a second.
const std::vector<std::size_t>& Monitor::mute_vehicles(double present) {
  if (present < ask_again_) return mute_;
  ask_again_ = present + 1.0;
  std::vector<std::size_t> heard;
  for (std::size_t i = 0; i <= configuration_.run.followers; ++i) {
    if (sends_input(configuration_.model, i, configuration_.run.followers)) heard.push_back(i);
  }
  return mute_ = heard.empty() ? heard : platoon::mute_vehicles(heard);
}

Diagnostics::Fill Monitor::status() {
  VitalSigns::Sources sources;
  for (const PositionInput& input : inputs_) sources.push_back(&input.counter());
  return [this, signs = VitalSigns(std::move(sources))](diagnostic_updater::DiagnosticStatusWrapper& status) mutable {
    signs(status);
    std::string who;
    std::uint64_t committed;
    std::uint32_t repeated = 0;
    {
      const Locked lock(lock_);
      who = stall_.culprit();
      if (stall_.stalled()) repeated = stall_.retries(statistics_.arrivals());
      committed = statistics_.arrivals().committed();
    }
    if (!who.empty()) status.summary(diagnostic_msgs::DiagnosticStatus::ERROR, "run stalled: " + who);
    status.add("culprit", who);
    status.add("retries", repeated);
    status.add("realizations", endless() ? 1 : committed);
  };
}

void Monitor::show_start(double present) {
  const std::vector<std::size_t> missing = missing_vehicles();
  std::string state;
  {
    const Locked lock(lock_);
    state = stall_.start(missing, statistics_.arrivals());
  }
  display_.prepare(state, present);
}

void Monitor::show_manoeuvre(bool departs) {
  if (std::exchange(departs_, departs) == departs) return;
  if (departs) {
    ROS_INFO("the leader manoeuvres: averages are paused until its effect has decayed");
  } else {
    const char* const later = has_limits(configuration_.model) ? ", later if limits hold a vehicle back" : "";
    ROS_INFO_STREAM("the leader drives by the model file again: averages go on in "
                    << duration_in_steps(configuration_.run.burn_in, configuration_.model) << later);
  }
}

void Monitor::publish_statistics_if_due(double present) {
  if (!publisher_.is_due(present)) return;
  RunResult result;
  {
    const Locked lock(lock_);
    if (statistics_.averages().empty()) return;
    result = statistics_.result(false);
  }
  publisher_.publish(result, present);
}

}  // namespace platoon
