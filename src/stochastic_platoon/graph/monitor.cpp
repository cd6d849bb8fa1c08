#include "stochastic_platoon/graph/monitor.hpp"

#include <ros/console.h>
#include <std_msgs/String.h>
#include <stochastic_platoon/ErrorStatistics.h>
#include <stochastic_platoon/Overview.h>

#include <algorithm>
#include <boost/function.hpp>
#include <chrono>
#include <cstdio>
#include <mutex>
#include <utility>

#include "stochastic_platoon/delivery/vehicle_name.hpp"
#include "stochastic_platoon/graph/overview.hpp"
#include "stochastic_platoon/io/atomic_file.hpp"
#include "stochastic_platoon/io/text.hpp"
#include "stochastic_platoon/messages/position.hpp"
#include "stochastic_platoon/messages/topics.hpp"
#include "stochastic_platoon/results/run_report.hpp"
#include "stochastic_platoon/theory/critical_headway.hpp"

namespace platoon {

using stochastic_platoon::ErrorStatistics;
using stochastic_platoon::Overview;
using stochastic_platoon::Position;
using stochastic_platoon::Progress;

namespace {

using Locked = std::lock_guard<SpinLock>;

constexpr double kCheckpointPeriod = 1.0;  // [s]
constexpr double kStatisticsPeriod = 1.0;  // [s] of an ensemble; an endless run publishes with every heartbeat

std::vector<std::string> topics_of(const ros::NodeHandle& platoon, const RunOptions& run) {
  std::vector<std::string> topics;
  for (std::size_t i = 0; i <= run.followers; ++i) topics.push_back(platoon.resolveName(position_topic(i)));
  return topics;
}

std::optional<Checkpoint> checkpoint_of(const Configuration& configuration) {
  std::optional<Checkpoint> found = starting_point(configuration);
  if (found && !found->damage.empty())
    ROS_WARN_STREAM(found->damage << ": going on from the one before it, of " << extent_of(*found));
  return found;
}

// [from, to, from, to, ...]; empty where there are none, or none are known.
std::vector<double> flat_stable_headways(const PlatoonModel& model) {
  std::vector<double> flat;
  if (theory_of(model) == Theory::none) return flat;
  if (const std::optional<StableHeadways> headways = stable_headways(model)) {
    for (const HeadwayInterval& of : headways->intervals) flat.insert(flat.end(), {of.from, of.to});
  }
  return flat;
}

std::vector<TrackingError> errors_of(const Configuration& configuration) {
  std::vector<TrackingError> errors;
  for (std::size_t i = 1; i <= configuration.run.followers; ++i)
    errors.push_back(tracking_error(configuration.model, i));
  return errors;
}

}  // namespace

Monitor::Monitor(ros::NodeHandle platoon, const Configuration& configuration, const NodeOfVehicle& node_of_vehicle,
                 RunMembership::Join superseded)
    : configuration_(configuration),
      output_(lock_output(configuration.run)),
      membership_(platoon, "monitor", run_identity(configuration), std::move(superseded)),
      prediction_(predict(configuration)),
      statistics_(configuration, checkpoint_of(configuration)),
      reports_(platoon, "monitor", configuration),
      stall_(configuration.run, topics_of(platoon, configuration.run)),
      display_(configuration.run.realizations, "realizations",
               static_cast<double>(configuration.run.followers) * static_cast<double>(configuration.run.steps),
               "vehicle-steps"),
      checkpointed_(statistics_.tally().positions_received),
      error_statistics_(platoon.advertise<ErrorStatistics>(kErrorStatisticsTopic, 1000, true)),
      overview_(platoon.advertise<Overview>(kOverviewTopic, 1, true)),
      configuration_text_(platoon.advertise<std_msgs::String>(kConfigurationTopic, 1, true)),
      snapshots_(platoon, kSnapshotTopic, configuration.run.followers + 1, errors_of(configuration)),
      change_(platoon, configuration, [this](const Configuration& next) { membership_.join(next); }) {
  snapshots_.set_rate(configuration.run.rate);
  wall_seconds_before_ = statistics_.tally().wall_seconds;
  reports_.saw(statistics_.tally().platoon_time);
  std_msgs::String text;
  ignore_file_size_signal();
  text.data = to_json(configuration).dump();
  configuration_text_.publish(text);
  if (endless()) headways_ = std::async(std::launch::async, flat_stable_headways, configuration.model).share();
  publish_overview({});  // the verdict need not wait for the first figures
  subscribe(platoon, node_of_vehicle);
  timer_ = platoon.createSteadyTimer(ros::WallDuration(kHeartbeat), [this](const auto&) { tick(); });
}

void Monitor::subscribe(ros::NodeHandle platoon, const NodeOfVehicle& node_of_vehicle) {
  const std::size_t followers = configuration_.run.followers;
  for (std::size_t i = 0; i <= followers; ++i) {
    const std::string external = configuration_.run.is_external(i) ? vehicle_name(i) : "";
    inputs_.emplace_back(membership_, platoon.resolveName(position_topic(i)), "", external);
  }
  for (std::size_t i = 0; i <= followers; ++i) {
    const boost::function<void(const PositionEvent&)> callback = [this, i](const PositionEvent& event) {
      receive(i, event);
    };
    positions_.push_back(node_of_vehicle(i).subscribe<Position, const PositionEvent&>(
        position_topic(i), kUnboundedQueue, callback, ros::VoidConstPtr(), no_delay()));
  }
  others_ = platoon.subscribe(kProgressTopic, 100, &Monitor::receive_notice, this);
}

void Monitor::receive(std::size_t vehicle, const PositionEvent& event) {
  const Position::ConstPtr message = event.getMessage();
  if (!inputs_[vehicle].admits(event)) return;
  const MessageDescriptor descriptor = descriptor_of(*message);
  RunStatistics::Receipt receipt;
  {
    const Locked lock(lock_);
    statistics_.saw(message->header.stamp.toNSec());
    reports_.saw(message->header.stamp.toNSec());
    receipt = statistics_.receive(vehicle, descriptor, positions_of(message));
  }
  if (!inputs_[vehicle].takes(receipt.verdict, descriptor.id, descriptor.size)) return;
  if (snapshots_.wanted()) snapshots_.take(vehicle, *message);
  const RunStatistics::Computed computed = statistics_.compute(receipt.work);
  const Locked lock(lock_);
  const double present = now();
  const bool committed = statistics_.settle(computed);
  stall_.note_arrival(statistics_.arrivals(), present);
  if (!began_ && statistics_.arrivals().acknowledgement().step != kNothingYet) began_ = present;
  if (committed) statistics_.set_wall_seconds(wall_seconds_before_ + (began_ ? present - *began_ : 0.0));
  reports_.report_if_due(statistics_.arrivals());
}

void Monitor::receive_notice(const Progress::ConstPtr& message) {
  if (message->receiver == "monitor" || message->run != membership_.run()) return;
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
    if (reports_.is_linked(positions_)) reports_.report(statistics_.arrivals());
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
  if (last_checkpoint_ && present - *last_checkpoint_ < kCheckpointPeriod) return;
  if (!disk_.is_due(present)) return;
  std::optional<Checkpoint> checkpoint;
  {
    const Locked lock(lock_);
    if (statistics_.tally().positions_received > checkpointed_) checkpoint = statistics_.checkpoint();
  }
  if (!checkpoint) return;
  if (!write(present, [&] { write_checkpoint(configuration_.run.output, *checkpoint); })) return;
  checkpointed_ = checkpoint->tally.positions_received;
  last_checkpoint_ = present;
}

// Does what the disk may refuse: then it is to be tried again when it is due. Whether it was done.
bool Monitor::write(double present, const std::function<void()>& work) {
  try {
    work();
  } catch (const std::runtime_error& error) {
    if (!disk_.is_on()) {
      ROS_ERROR_STREAM(error.what() << "; " << free_space(checkpoint_file(configuration_.run.output))
                                    << ". It is tried again until there is room; the run goes on");
    }
    disk_.failed(present);
    return false;
  }
  if (disk_.is_on()) ROS_WARN_STREAM(configuration_.run.output << ": can be written again");
  disk_.succeeded();
  return true;
}

void Monitor::finish() {
  if (!disk_.is_due(now())) return;
  std::optional<Checkpoint> checkpoint;
  RunResult result;
  {
    const Locked lock(lock_);
    checkpoint = statistics_.checkpoint();
    result = statistics_.result(true);
  }
  display_.update(result.realizations, now());
  const bool written = write(now(), [&] {
    write_checkpoint(configuration_.run.output, *checkpoint);
    write_results(configuration_, prediction_, result);
  });
  if (!written) return;
  display_.finish();
  for (std::int64_t k = 0; k < configuration_.run.steps; ++k) publish_statistics(k, result);
  publish_overview(result);
  std::printf("%sResults: %s/statistics.csv and summary.json\n", report(configuration_, prediction_, result).c_str(),
              configuration_.run.output.c_str());
  std::fflush(stdout);
  finished_ = true;
  const Locked lock(lock_);
  reports_.set_finished();
  reports_.report(statistics_.arrivals());
}

void Monitor::stop() {
  if (finished_ || statistics_.averages().empty()) return;
  display_.finish();
  if (endless() && began_) statistics_.set_wall_seconds(wall_seconds_before_ + now() - *began_);
  const Checkpoint checkpoint = statistics_.checkpoint();
  if (checkpoint.tally.positions_received > checkpointed_) write_checkpoint(configuration_.run.output, checkpoint);
  const RunResult partial = statistics_.result(false);
  write_results(configuration_, prediction_, partial);
  std::printf("%s", report(configuration_, prediction_, partial).c_str());
  if (!endless()) {
    std::printf("Stopped after %llu of %llu realizations. ", static_cast<unsigned long long>(partial.realizations),
                static_cast<unsigned long long>(configuration_.run.realizations));
  }
  std::printf("The same launch with output:=%s resume:=true goes on from there.\n", configuration_.run.output.c_str());
  std::fflush(stdout);
}

// Logs a stall once when it begins, when its reason changes, and once when it ends.
void Monitor::check_for_stall(double present) {
  StallReporter::Change change;
  {
    const Locked lock(lock_);
    change = stall_.look({statistics_.arrivals(), began_.has_value(), [this] { return missing_vehicles(); },
                          [this](std::size_t vehicle) { return inputs_[vehicle].latest_breach(); }},
                         present);
  }
  if (!change.stalled.empty()) ROS_WARN_STREAM("the platoon stands still: " << change.stalled);
  if (!change.moving.empty()) ROS_WARN_STREAM("the platoon moves again" << change.moving);
}

std::vector<std::size_t> Monitor::missing_vehicles() const {
  std::vector<std::size_t> missing;
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    if (positions_[i].getNumPublishers() == 0) missing.push_back(i);
  }
  return missing;
}

Diagnostics::Fill Monitor::status() {
  VitalSigns::Sources sources;
  for (const PositionInput& input : inputs_) sources.emplace_back(&input.activity(), &input.drops());
  return [this, signs = VitalSigns(std::move(sources))](diagnostic_updater::DiagnosticStatusWrapper& status) mutable {
    signs.add_to(status);
    std::string who;
    std::uint64_t committed;
    std::uint32_t repeated = 0;
    {
      const Locked lock(lock_);
      who = stall_.culprit();
      if (stall_.stalled()) repeated = stall_.retries(statistics_.arrivals());
      committed = statistics_.arrivals().committed();
    }
    if (!who.empty()) status.summary(diagnostic_msgs::DiagnosticStatus::ERROR, "the platoon stands still: " + who);
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
  if (departs == departs_) return;
  departs_ = departs;
  if (departs) {
    ROS_INFO("the leader manoeuvres: averages leave out what it causes");
  } else {
    ROS_INFO_STREAM("the leader drives by the model file again: averages go on in " << configuration_.run.burn_in
                                                                                    << " steps");
  }
}

void Monitor::publish_statistics_if_due(double present) {
  if (!endless() && last_statistics_ && present - *last_statistics_ < kStatisticsPeriod) return;
  RunResult result;
  {
    const Locked lock(lock_);
    if (statistics_.averages().empty()) return;
    result = statistics_.result(false);
  }
  last_statistics_ = present;
  publish_statistics(result.last_step, result);
  if (overview_.getNumSubscribers() > 0) publish_overview(result);
}

void Monitor::publish_statistics(std::int64_t step, const RunResult& result) {
  ErrorStatistics message;
  message.header.stamp = platoon_time(result.tally.platoon_time);
  message.step = step;
  message.realizations = result.realizations;
  message.time_average = endless();
  for (const ResultCell& of : ResultCells(configuration_.run, prediction_, result).at(step)) {
    message.mean.push_back(of.measured.mean);
    message.variance.push_back(of.measured.variance());
    message.theoretical_mean.push_back(of.theoretical_mean);
    message.theoretical_variance.push_back(of.theoretical_variance);
  }
  error_statistics_.publish(message);
}

void Monitor::publish_overview(const RunResult& result) {
  Overview message = overview_of(configuration_.run, prediction_, result);
  message.run = membership_.run();
  if (headways_.valid() && headways_.wait_for(std::chrono::seconds(0)) == std::future_status::ready)
    message.stable_headways = headways_.get();
  overview_.publish(message);
}

}  // namespace platoon
