#include "stochastic_platoon/ros/observation/snapshots.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "stochastic_platoon/ros/messages/position.hpp"
#include "stochastic_platoon/ros/transport/kept_topics.hpp"
#include "stochastic_platoon/ros/transport/transport.hpp"

namespace platoon {

namespace {
constexpr double kSnapshotPeriod = 0.05;  // [s]
}

Snapshots::Snapshots(ros::NodeHandle platoon, const std::string& topic, std::size_t streams, std::vector<Signal> errors,
                     double sample_period)
    : errors_(std::move(errors)),
      sample_period_(sample_period),
      assembly_(streams, kSnapshotPeriod),
      publisher_(advertise_kept<stochastic_platoon::Snapshot>(platoon, topic, 10)) {
  timer_ = platoon.createSteadyTimer(ros::WallDuration(kSnapshotPeriod), [this](const auto&) { publish(); });
}

void Snapshots::set_rate(double rate) {
  paced_ = rate > 0.0;
  const Locked lock(lock_);
  assembly_.set_stride(std::max<std::int64_t>(1, std::llround(std::ceil(std::min(rate, 1e9) * kSnapshotPeriod))));
}

void Snapshots::take(std::size_t stream, const stochastic_platoon::Position& message) {
  if (message.position.empty()) return;
  const double present = now();
  const Locked lock(lock_);
  if (message.run != run_) {
    assembly_.clear();
    complete_.reset();  // else the last one of the old run would be published as one of the new run
  }
  run_ = message.run;
  std::optional<Snapshot> complete = assembly_.take(stream, id_of(message), message.position.front(), present);
  if (!complete) return;
  complete_ = std::move(complete);
  stamp_ = message.header.stamp;
}

// Called by the timer only: the threads that take positions never publish.
void Snapshots::publish() {
  const bool watched = publisher_.getNumSubscribers() > 0;
  const bool was_wanted = wanted_.exchange(watched || paced_);
  stochastic_platoon::Snapshot message;
  std::optional<Snapshot> complete;
  {
    const Locked lock(lock_);
    if (was_wanted && !wanted_) assembly_.clear();
    complete = std::exchange(complete_, std::nullopt);
    message.run = run_;
    message.header.stamp = stamp_;
  }
  if (!complete || !watched) return;
  message.realization = complete->id.first_realization;
  message.step = complete->id.step;
  const std::vector<double>& own = complete->position;
  for (std::size_t i = 1; i <= errors_.size(); ++i)
    message.tracking_error.push_back(errors_[i - 1]({own[i - 1]}, {own[i], complete->position_before[i]}));
  for (std::size_t i = 0; i < own.size() && !errors_.empty(); ++i)
    message.speed.push_back((own[i] - complete->position_before[i]) / sample_period_);
  message.position = std::move(complete->position);
  publisher_.publish(message);
}

}  // namespace platoon
