#include "stochastic_platoon/graph/leader.hpp"

#include <ros/console.h>

#include <algorithm>

#include "stochastic_platoon/graph/progress_reports.hpp"
#include "stochastic_platoon/graph/transport.hpp"
#include "stochastic_platoon/io/text.hpp"
#include "stochastic_platoon/messages/position.hpp"
#include "stochastic_platoon/messages/topics.hpp"

namespace platoon {

using stochastic_platoon::Position;
using stochastic_platoon::Progress;

namespace {

// The first step of an attempt passes through the string from vehicle to vehicle, each of which may touch its
// memory for the first time. Grows by itself: see Credit.
double first_step_timeout(const RunOptions& run) {
  constexpr double kForAll = 0.1;        // [s]
  constexpr double kPerVehicle = 0.01;   // [s]
  constexpr double kPerPosition = 5e-7;  // [s]
  const auto followers = static_cast<double>(run.followers);
  const double sought = kForAll + followers * (kPerVehicle + kPerPosition * static_cast<double>(run.batch));
  return std::min(sought, run.stall_timeout);
}

constexpr double kWatchPeriod = 0.02;  // [s]

}  // namespace

Leader::Leader(ros::NodeHandle platoon, const Configuration& configuration, RunMembership::Join superseded)
    : membership_(platoon, "vehicle_0", run_identity(configuration), std::move(superseded)),
      schedule_(configuration.run.schedule()),
      period_(platoon_period(configuration.model.sample_period)),
      window_(configuration.run.window),
      paced_(configuration.run.rate > 0.0),
      credit_(schedule_, {window_, configuration.run.stall_timeout, first_step_timeout(configuration.run)},
              configuration.run.receivers()),
      vehicle_(configuration.model),
      position_(platoon.advertise<Position>(position_topic(0), kUnboundedQueue)),
      progress_(platoon.subscribe(kProgressTopic, kUnboundedQueue, &Leader::receive, this, no_delay())) {
  for (const std::string& name : configuration.run.receivers())
    reporters_.emplace(name, SolePublisher(platoon.resolveName(kProgressTopic) + " of " + name));
  stall_timer_ = platoon.createSteadyTimer(ros::WallDuration(kWatchPeriod), [this](const auto&) { watch(); });
  if (paced_) {
    pace_timer_ = platoon.createSteadyTimer(ros::WallDuration(1.0 / configuration.run.rate),
                                            [this](const auto&) { publish_one(); });
  }
}

void Leader::receive(const ros::MessageEvent<const Progress>& event) {
  const Progress::ConstPtr message = event.getMessage();
  if (!membership_.admits(message->run)) return;
  const Acknowledgement report{message->attempt, message->first_realization, message->step};
  const auto reporter = reporters_.find(message->receiver);
  if (reporter != reporters_.end()) {
    if (!reporter->second.admits(event.getConnectionHeaderPtr(), message->run)) return;
    if (!may_be_reported(schedule_, report)) {
      ROS_WARN_STREAM_THROTTLE(1.0, "progress: ignored a report of \""
                                        << reporter->first
                                        << "\" of what this run does not have: realizations from "
                                        << report.first_realization << ", step " << report.step);
      return;
    }
  }
  if (!credit_.acknowledge(message->receiver, report, now(), message->messages)) {
    if (message->note.rfind(kMissed, 0) == 0) {
      credit_.give_up(message->attempt, now());
      return publish_allowed();
    }
    const bool notice = !message->note.empty();  // of a vehicle that cannot take part: the monitor's business
    if (notice) return;
    ROS_WARN_STREAM_THROTTLE(1.0, "progress: ignored a report from \""
                                      << printable(shortened(message->receiver))
                                      << "\": it is no receiver of this run");
    return;
  }
  if (message->note.rfind(kHoldsUp, 0) == 0) {
    holding_.insert(message->receiver);
  } else {
    holding_.erase(message->receiver);
  }
  if (paced_ && credit_.attempt() == 0 && message->attempt == 0 && !begin_) begin_ = now() + kObserverTime;
  // After a restart time goes on past everything that may still be on its way.
  ros::Time seen = message->header.stamp;
  if (credit_.attempt() == 0 && !seen.isZero()) {
    for (std::int64_t step = 0; step <= window_; ++step) seen = later(seen, period_);
    stamp_ = std::max(stamp_, seen);
  }
  publish_allowed();
}

void Leader::watch() {
  // To begin again is of no use before there is room.
  if (holding_.empty() && credit_.retry_if_stalled(now())) {
    ROS_DEBUG_STREAM("no progress: attempt " << credit_.attempt() << " begins");
  }
  publish_allowed();
}

void Leader::publish_allowed() {
  while (!paced_ && publish_one()) {
  }
}

bool Leader::publish_one() {
  if (begin_ && now() < *begin_) return false;
  const std::optional<MessageId> id = credit_.next(now());
  if (!id) return false;
  stamp_ = later(stamp_, period_);
  const double position = id->step == kInitialStep ? vehicle_.start() : vehicle_.step();
  const auto message = messages_.take();
  message->header.stamp = stamp_;
  set_id(membership_.run(), *id, *message);
  message->position.assign(schedule_.size(id->first_realization), position);
  platoon::publish(position_, message);
  return true;
}

}  // namespace platoon
