#include "stochastic_platoon/graph/monitor.hpp"

#include <ros/console.h>
#include <stochastic_platoon/Progress.h>

#include <algorithm>
#include <boost/function.hpp>
#include <cstdio>

#include "stochastic_platoon/delivery/culprit.hpp"
#include "stochastic_platoon/graph/wire.hpp"
#include "stochastic_platoon/results/atomic_file.hpp"

namespace platoon {

using stochastic_platoon::ErrorStatistics;
using stochastic_platoon::Position;
using stochastic_platoon::Progress;

namespace {

constexpr double kHeartbeat = 0.1;         // [s]
constexpr double kCheckpointPeriod = 1.0;  // [s]
constexpr double kStatisticsPeriod =
    1.0;  // [s] of an ensemble; an endless run publishes with every heartbeat

double now() {
  return ros::SteadyTime::now().toSec();
}

// Shares the message's array without copying it.
Positions positions_of(const Position::ConstPtr& message) {
  return Positions(&message->position, [message](const std::vector<double>*) {});
}

}  // namespace

Monitor::Monitor(ros::NodeHandle platoon, const Configuration& configuration)
    : configuration_(configuration),
      prediction_(predict(configuration)),
      start_(endless() ? std::nullopt : starting_point(configuration)),
      ensemble_(configuration.run.followers, configuration.run.steps),
      time_averages_(configuration.run.followers, configuration.run.burn_in),
      tally_(start_ ? start_->tally : Tally{}),
      assembly_(configuration.run.schedule(), configuration.run.followers,
                {configuration.model.headway, configuration.model.standstill_distance},
                start_ ? start_->table.count() : 0, tally_.attempts,
                {[this](std::size_t follower, const Turn& turn, const auto& errors) {
                   take_errors(follower, turn, errors);
                 },
                 [this](const CompleteBatch& batch) { commit(batch); }, [this] { restart(); }}),
      display_(
          configuration.run.realizations, "realizations",
          static_cast<double>(configuration.run.followers) * static_cast<double>(configuration.run.steps),
          "vehicle-steps"),
      wall_seconds_before_(tally_.wall_seconds),
      progress_(platoon.advertise<Progress>("progress", kUnboundedQueue)),
      error_statistics_(platoon.advertise<ErrorStatistics>("error_statistics", 1000, true)) {
  if (endless()) require_writable_folder(configuration.run.output);
  if (start_) ensemble_.merge(start_->table);
  checkpointed_ = assembly_.arrivals().committed();
  for (std::size_t i = 0; i <= configuration.run.followers; ++i) {
    refusals_.emplace_back(platoon.resolveName(position_topic(i)));
  }
  for (std::size_t i = 0; i <= configuration.run.followers; ++i) {
    const boost::function<void(const Position::ConstPtr&)> callback =
        [this, i](const Position::ConstPtr& message) { receive(i, message); };
    positions_.push_back(platoon.subscribe<Position>(position_topic(i), kUnboundedQueue, callback,
                                                     ros::VoidConstPtr(), no_delay()));
  }
  notes_ = platoon.subscribe<Progress>(
      "progress", 10,
      boost::function<void(const Progress::ConstPtr&)>([this](const Progress::ConstPtr& message) {
        if (message->receiver != "monitor") display_.set_note(message->note);
      }));
  timer_ = platoon.createSteadyTimer(ros::WallDuration(kHeartbeat), [this](const auto&) { tick(); });
}

void Monitor::receive(std::size_t vehicle, const Position::ConstPtr& message) {
  const Turn turn = turn_of(*message);
  tally_.platoon_time = std::max(tally_.platoon_time, message->header.stamp.toNSec());
  const Verdict verdict = assembly_.receive(vehicle, turn, positions_of(message));
  if (verdict != Verdict::in_turn) {
    refusals_[vehicle].count(verdict, turn, message->position.size());
    return;
  }
  last_arrival_ = now();
  tally_.attempts = std::max(tally_.attempts, turn.attempt);
  if (endless()) tally_.positions_received += message->position.size();
  if (assembly_.arrivals().complete() && !finished_) finish();
  const Acknowledgement present = assembly_.arrivals().acknowledgement();
  if (began_ < 0.0 && present.step != kNothingYet) began_ = last_arrival_;
  if (present.first_realization != acknowledged_.first_realization || present.step != acknowledged_.step ||
      present.attempt != acknowledged_.attempt) {
    publish_progress();
  }
}

void Monitor::take_errors(std::size_t follower, const Turn& turn, const std::vector<double>& errors) {
  if (!endless()) return ensemble_.add(follower, turn.step, turn.first_realization, errors);
  time_averages_.add(follower, turn.step, errors.front());
  last_step_ = std::max(last_step_, turn.step);
}

void Monitor::restart() {
  ensemble_.discard_open();
  time_averages_.restart();
  last_step_ = kNothingYet;
  if (endless()) tally_.positions_received = 0;
}

void Monitor::commit(const CompleteBatch& batch) {
  ensemble_.commit(batch.first_realization);
  tally_.positions_received += batch.positions_received;
  const double present = now();
  tally_.wall_seconds = wall_seconds_before_ + (present - began_);
  if (present - last_checkpoint_ >= kCheckpointPeriod) save_checkpoint(present);
}

void Monitor::save_checkpoint(double time) {
  write_checkpoint(configuration_.run.output, {statistics_identity(configuration_), configuration_.run.launch,
                                               tally_, ensemble_.committed()});
  last_checkpoint_ = time;
  checkpointed_ = ensemble_.committed().count();
}

std::vector<Moments> Monitor::moments() const {
  return endless() ? time_averages_.moments() : ensemble_.committed().totals();
}

RunResult Monitor::result() const {
  return {finished_, endless() ? 1 : ensemble_.committed().count(), std::max<std::int64_t>(last_step_, 0),
          tally_, moments()};
}

void Monitor::finish() {
  finished_ = true;
  save_checkpoint(now());
  const RunResult final = result();
  write_results(configuration_, prediction_, final);
  display_.update(assembly_.arrivals().committed(), now());
  display_.finish();
  for (std::int64_t k = 0; k < configuration_.run.steps; ++k) publish_statistics(k, final.moments);
  std::printf("%sResults: %s/statistics.csv and summary.json\n",
              report(configuration_, prediction_, final).c_str(), configuration_.run.output.c_str());
  std::fflush(stdout);
}

void Monitor::stop() {
  if (finished_ || (endless() && last_step_ < 0)) return;
  display_.finish();
  if (endless()) {
    tally_.wall_seconds = now() - began_;
  } else {
    if (ensemble_.committed().count() > checkpointed_) save_checkpoint(now());
    if (ensemble_.committed().count() == 0) return;
  }
  const RunResult partial = result();
  write_results(configuration_, prediction_, partial);
  std::printf("%s", report(configuration_, prediction_, partial).c_str());
  if (!endless()) {
    std::printf(
        "Stopped after %llu of %llu realizations; the same launch with output:=%s resume:=true goes on from "
        "there.\n",
        static_cast<unsigned long long>(partial.realizations),
        static_cast<unsigned long long>(configuration_.run.realizations), configuration_.run.output.c_str());
  }
  std::fflush(stdout);
}

void Monitor::tick() {
  const double present = now();
  if (assembly_.arrivals().complete() && !finished_) finish();  // resumed when nothing was left to do
  if (!is_linked()) return report_stall(present);
  publish_progress();
  if (finished_) return;
  if (!endless() && began_ >= 0.0) display_.update(assembly_.arrivals().committed(), present);
  report_stall(present);
  if (endless() ? last_step_ >= 0 : ensemble_.committed().count() > 0) {
    if (!endless() && present - last_statistics_ < kStatisticsPeriod) return;
    last_statistics_ = present;
    publish_statistics(endless() ? last_step_ : configuration_.run.steps - 1, moments());
  }
}

// The leader waits for the first report: it comes when every vehicle can be heard, so that no attempt is
// wasted before.
bool Monitor::is_linked() {
  linked_ = linked_ || std::all_of(positions_.begin(), positions_.end(), [](const ros::Subscriber& position) {
              return position.getNumPublishers() > 0;
            });
  return linked_;
}

// Said once when it is noticed and once when it is over.
void Monitor::report_stall(double present) {
  const double pace = configuration_.run.rate > 0.0 ? 1.0 / configuration_.run.rate : 0.0;
  if (last_arrival_ < 0.0) last_arrival_ = present;
  const bool stalled = present - last_arrival_ > 0.75 * configuration_.run.stall_timeout + pace;
  if (stalled && !stalled_) {
    ROS_WARN_STREAM("the platoon stands still: " << culprit(assembly_.arrivals().latest(),
                                                            configuration_.run.schedule()));
  } else if (!stalled && stalled_) {
    ROS_WARN("the platoon moves again");
  }
  stalled_ = stalled;
}

void Monitor::publish_progress() {
  acknowledged_ = assembly_.arrivals().acknowledgement();
  Progress message;
  message.header.stamp.fromNSec(tally_.platoon_time);
  message.receiver = "monitor";
  message.attempt = acknowledged_.attempt;
  message.first_realization = acknowledged_.first_realization;
  message.step = acknowledged_.step;
  message.finished = finished_;
  progress_.publish(message);
}

void Monitor::publish_statistics(std::int64_t step, const std::vector<Moments>& all) {
  const std::size_t followers = configuration_.run.followers;
  ErrorStatistics message;
  message.header.stamp.fromNSec(tally_.platoon_time);
  message.step = step;
  message.realizations = endless() ? 1 : ensemble_.committed().count();
  message.time_average = endless();
  for (std::size_t i = 1; i <= followers; ++i) {
    const std::size_t c = endless() ? i - 1 : cell(i, step, configuration_.run.steps);
    message.mean.push_back(all[c].mean);
    message.variance.push_back(all[c].variance());
    message.theoretical_mean.push_back(prediction_.mean[c]);
    message.theoretical_variance.push_back(prediction_.variance[c]);
  }
  error_statistics_.publish(message);
}

}  // namespace platoon
