#include "stochastic_platoon/graph/leader.hpp"

#include <ros/console.h>

#include <algorithm>

#include "stochastic_platoon/bags/bag_statistics.hpp"
#include "stochastic_platoon/graph/wire.hpp"

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

Leader::Leader(ros::NodeHandle platoon, const Configuration& configuration)
    : schedule_(configuration.run.schedule()),
      period_(platoon_period(configuration.model.sample_period)),
      window_(configuration.run.window),
      paced_(configuration.run.rate > 0.0),
      credit_(schedule_, {window_, configuration.run.stall_timeout, first_step_timeout(configuration.run)},
              configuration.run.receivers()),
      vehicle_(configuration.model),
      recorded_(recorded_leader(bag_files(configuration.run.leader_bags), configuration.run.steps)),
      position_(platoon.advertise<Position>(position_topic(0), kUnboundedQueue)),
      progress_(platoon.subscribe("progress", kUnboundedQueue, &Leader::receive, this, no_delay())) {
  stall_timer_ = platoon.createSteadyTimer(ros::WallDuration(kWatchPeriod), [this](const auto&) { watch(); });
  if (paced_) {
    pace_timer_ = platoon.createSteadyTimer(ros::WallDuration(1.0 / configuration.run.rate),
                                            [this](const auto&) { publish_one(); });
  }
}

void Leader::receive(const Progress::ConstPtr& message) {
  if (!credit_.acknowledge(message->receiver, {message->attempt, message->first_realization, message->step},
                           now())) {
    ROS_WARN_STREAM_THROTTLE(1.0, "progress: ignored a report from \""
                                      << message->receiver << "\": it is no receiver of this run");
    return;
  }
  if (paced_ && credit_.attempt() == 0 && message->attempt == 0 && begin_ == 0.0)
    begin_ = now() + kObserverTime;
  // After a restart time goes on past everything that may still be on its way.
  const ros::Time seen = message->header.stamp;
  if (credit_.attempt() == 0 && !seen.isZero()) {
    const ros::Duration in_flight = ros::Duration().fromNSec(period_.toNSec() * (window_ + 1));
    stamp_ = std::max(stamp_, seen + in_flight);
  }
  publish_allowed();
}

void Leader::watch() {
  if (credit_.retry_if_stalled(now())) {
    ROS_DEBUG_STREAM("no progress: attempt " << credit_.attempt() << " begins");
  }
  publish_allowed();
}

void Leader::publish_allowed() {
  while (!paced_ && publish_one()) {
  }
}

// In the order of steps, each batch from -1 on.
double Leader::position_at(std::int64_t step) {
  if (!recorded_.empty()) return recorded_[static_cast<std::size_t>(step + 1)];
  return step == kInitialStep ? vehicle_.start() : vehicle_.step();
}

bool Leader::publish_one() {
  if (now() < begin_) return false;
  const std::optional<Turn> turn = credit_.next(now());
  if (!turn) return false;
  stamp_ += period_;
  const double position = position_at(turn->step);
  const auto message = messages_.take();
  message->header.stamp = stamp_;
  set_turn(*turn, *message);
  message->position.assign(schedule_.size(turn->first_realization), position);
  platoon::publish(position_, message);
  return true;
}

}  // namespace platoon
