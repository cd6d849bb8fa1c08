#include "stochastic_platoon/graph/monitor.hpp"

#include <ros/console.h>
#include <std_msgs/String.h>
#include <stochastic_platoon/Progress.h>

#include <algorithm>
#include <boost/function.hpp>
#include <cstdio>
#include <mutex>

#include "stochastic_platoon/bags/bag_statistics.hpp"
#include "stochastic_platoon/delivery/culprit.hpp"
#include "stochastic_platoon/graph/wire.hpp"
#include "stochastic_platoon/results/atomic_file.hpp"

namespace platoon {

using stochastic_platoon::ErrorStatistics;
using stochastic_platoon::Position;
using stochastic_platoon::Progress;

namespace {

constexpr double kCheckpointPeriod = 1.0;  // [s]
constexpr double kStartTime = 0.05;        // [s] a vehicle, from launch to its first message
constexpr double kStatisticsPeriod =
    1.0;  // [s] of an ensemble; an endless run publishes with every heartbeat

// Shares the message's array without copying it.
Positions positions_of(const Position::ConstPtr& message) {
  return Positions(&message->position, [message](const std::vector<double>*) {});
}

}  // namespace

Monitor::Monitor(ros::NodeHandle platoon, const Configuration& configuration,
                 const std::function<ros::NodeHandle(std::size_t)>& of_vehicle)
    : configuration_(configuration),
      prediction_(predict(
          configuration, recorded_leader(bag_files(configuration.run.leader_bags), configuration.run.steps))),
      statistics_(configuration, configuration.run.steps == 0 ? std::nullopt : starting_point(configuration),
                  [this](const std::function<void()>& work) {
                    const Unlocked<SpinLock> unlocked(lock_);
                    work();
                  }),
      display_(
          configuration.run.realizations, "realizations",
          static_cast<double>(configuration.run.followers) * static_cast<double>(configuration.run.steps),
          "vehicle-steps"),
      wall_seconds_before_(statistics_.tally.wall_seconds),
      committed_(statistics_.arrivals().committed()),
      checkpointed_(committed_),
      reports_(platoon, "monitor", configuration.run),
      error_statistics_(platoon.advertise<ErrorStatistics>("error_statistics", 1000, true)),
      configuration_text_(platoon.advertise<std_msgs::String>("configuration", 1, true)) {
  reports_.saw(statistics_.tally.platoon_time);
  if (statistics_.endless()) require_writable_folder(configuration.run.output);
  std_msgs::String text;
  text.data = to_json(configuration).dump();
  configuration_text_.publish(text);
  for (std::size_t i = 0; i <= configuration.run.followers; ++i) {
    refusals_.emplace_back(platoon.resolveName(position_topic(i)));
  }
  for (std::size_t i = 0; i <= configuration.run.followers; ++i) {
    const boost::function<void(const Position::ConstPtr&)> callback =
        [this, i](const Position::ConstPtr& message) { receive(i, message); };
    positions_.push_back(of_vehicle(i).subscribe<Position>(position_topic(i), kUnboundedQueue, callback,
                                                           ros::VoidConstPtr(), no_delay()));
  }
  notes_ = platoon.subscribe<Progress>(
      "progress", 10,
      boost::function<void(const Progress::ConstPtr&)>([this](const Progress::ConstPtr& message) {
        const std::lock_guard<SpinLock> lock(lock_);
        if (message->receiver != "monitor") display_.set_note(message->note);
      }));
  timer_ = platoon.createSteadyTimer(ros::WallDuration(kHeartbeat), [this](const auto&) { tick(); });
}

void Monitor::receive(std::size_t vehicle, const Position::ConstPtr& message) {
  const std::lock_guard<SpinLock> lock(lock_);
  const Turn turn = turn_of(*message);
  statistics_.tally.platoon_time = std::max(statistics_.tally.platoon_time, message->header.stamp.toNSec());
  reports_.saw(statistics_.tally.platoon_time);
  const Verdict verdict = statistics_.receive(vehicle, turn, positions_of(message));
  if (verdict != Verdict::in_turn) return refusals_[vehicle].count(verdict, turn, message->position.size());
  last_arrival_ = now();
  const Arrivals& arrivals = statistics_.arrivals();
  const Acknowledgement present = arrivals.acknowledgement();
  if (began_ < 0.0 && present.step != kNothingYet) began_ = last_arrival_;
  if (arrivals.committed() > committed_) note_commit();
  if (arrivals.complete() && !finished_) finish();
  reports_.report_if_due(present);
}

void Monitor::note_commit() {
  committed_ = statistics_.arrivals().committed();
  statistics_.tally.wall_seconds = wall_seconds_before_ + (last_arrival_ - began_);
  if (last_arrival_ - last_checkpoint_ >= kCheckpointPeriod) save_checkpoint();
}

void Monitor::save_checkpoint() {
  write_checkpoint(configuration_.run.output, statistics_.checkpoint());
  last_checkpoint_ = now();
  checkpointed_ = committed_;
}

void Monitor::finish() {
  finished_ = true;
  reports_.set_finished();
  save_checkpoint();
  const RunResult final = statistics_.result(true);
  write_results(configuration_, prediction_, final);
  display_.update(committed_, now());
  display_.finish();
  for (std::int64_t k = 0; k < configuration_.run.steps; ++k) publish_statistics(k, final.moments);
  std::printf("%sResults: %s/statistics.csv and summary.json\n",
              report(configuration_, prediction_, final).c_str(), configuration_.run.output.c_str());
  std::fflush(stdout);
}

void Monitor::stop() {
  if (finished_ || statistics_.empty()) return;
  display_.finish();
  if (statistics_.endless()) statistics_.tally.wall_seconds = now() - began_;
  if (committed_ > checkpointed_) save_checkpoint();
  const RunResult partial = statistics_.result(false);
  write_results(configuration_, prediction_, partial);
  std::printf("%s", report(configuration_, prediction_, partial).c_str());
  if (!statistics_.endless()) {
    std::printf(
        "Stopped after %llu of %llu realizations; the same launch with output:=%s resume:=true goes on from "
        "there.\n",
        static_cast<unsigned long long>(partial.realizations),
        static_cast<unsigned long long>(configuration_.run.realizations), configuration_.run.output.c_str());
  }
  std::fflush(stdout);
}

void Monitor::tick() {
  const std::lock_guard<SpinLock> lock(lock_);
  const double present = now();
  if (statistics_.arrivals().complete() && !finished_) finish();  // resumed when nothing was left to do
  if (!reports_.is_linked(positions_)) return report_stall(present);
  reports_.report(statistics_.arrivals().acknowledgement());
  if (finished_) return;
  if (!statistics_.endless() && began_ >= 0.0) display_.update(committed_, present);
  report_stall(present);
  if (statistics_.empty()) return;
  if (!statistics_.endless() && present - last_statistics_ < kStatisticsPeriod) return;
  last_statistics_ = present;
  publish_statistics(statistics_.last_step(), statistics_.moments());
}

// Said once when it is noticed and once when it is over.
void Monitor::report_stall(double present) {
  const double rate = configuration_.run.rate;
  const double pace = rate > 0.0 ? 1.0 / rate + (began_ < 0.0 ? kObserverTime : 0.0) : 0.0;
  const double start = began_ < 0.0 ? kStartTime * static_cast<double>(configuration_.run.followers) : 0.0;
  if (last_arrival_ < 0.0) last_arrival_ = present;
  const bool stalled = present - last_arrival_ > 0.75 * configuration_.run.stall_timeout + pace + start;
  if (stalled && !stalled_) {
    ROS_WARN_STREAM("the platoon stands still: " << culprit(statistics_.arrivals().latest(),
                                                            configuration_.run.schedule()));
  } else if (!stalled && stalled_) {
    ROS_WARN("the platoon moves again");
  }
  stalled_ = stalled;
}

void Monitor::publish_statistics(std::int64_t step, const std::vector<Moments>& all) {
  const std::size_t followers = configuration_.run.followers;
  ErrorStatistics message;
  message.header.stamp.fromNSec(statistics_.tally.platoon_time);
  message.step = step;
  message.realizations = statistics_.realizations();
  message.time_average = statistics_.endless();
  for (std::size_t i = 1; i <= followers; ++i) {
    const std::size_t c = statistics_.endless() ? i - 1 : cell(i, step, configuration_.run.steps);
    message.mean.push_back(all[c].mean);
    message.variance.push_back(all[c].variance());
    message.theoretical_mean.push_back(prediction_.mean[c]);
    message.theoretical_variance.push_back(prediction_.variance[c]);
  }
  error_statistics_.publish(message);
}

}  // namespace platoon
