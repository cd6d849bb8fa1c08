#include "stochastic_platoon/graph/recorder.hpp"

#include <ros/console.h>
#include <stochastic_platoon/Progress.h>

#include <algorithm>
#include <boost/function.hpp>

#include "stochastic_platoon/graph/wire.hpp"
#include "stochastic_platoon/results/text.hpp"

namespace platoon {

using stochastic_platoon::ErrorStatistics;
using stochastic_platoon::Position;
using stochastic_platoon::Progress;

namespace {

constexpr double kHeartbeat = 0.1;  // [s]

double now() {
  return ros::SteadyTime::now().toSec();
}

std::string parent_of(const std::string& name) {
  return name.substr(0, name.rfind('/'));
}

}  // namespace

Recorder::Recorder(ros::NodeHandle platoon, const Configuration& configuration)
    : recorder_(configuration, parent_of(platoon.resolveName("configuration"))),
      progress_(platoon.advertise<Progress>("progress", kUnboundedQueue)) {
  const std::size_t streams = 2 * configuration.run.followers + 1;
  for (std::size_t s = 0; s < streams; ++s) refusals_.emplace_back(recorder_.topic(s));
  for (std::size_t s = 0; s < streams; ++s) {
    const boost::function<void(const Position::ConstPtr&)> callback =
        [this, s](const Position::ConstPtr& message) { receive(s, message); };
    positions_.push_back(platoon.subscribe<Position>(recorder_.topic(s), kUnboundedQueue, callback,
                                                     ros::VoidConstPtr(), no_delay()));
  }
  error_statistics_ =
      platoon.subscribe("error_statistics", kUnboundedQueue, &Recorder::receive_statistics, this, no_delay());
  timer_ = platoon.createSteadyTimer(ros::WallDuration(kHeartbeat), [this](const auto&) { tick(); });
}

void Recorder::receive(std::size_t stream, const Position::ConstPtr& message) {
  platoon_time_ = std::max(platoon_time_, message->header.stamp.toNSec());
  const Verdict verdict = recorder_.receive(stream, message);
  if (verdict != Verdict::in_turn) {
    const Turn turn = turn_of(*message);
    return refusals_[stream].count(verdict, turn, message->position.size());
  }
  if (began_ < 0.0) began_ = now();
  const Acknowledgement present = recorder_.arrivals().acknowledgement();
  if (present.first_realization != acknowledged_.first_realization || present.step != acknowledged_.step ||
      present.attempt != acknowledged_.attempt) {
    publish_progress();
  }
  finish();
}

void Recorder::receive_statistics(const ErrorStatistics::ConstPtr& message) {
  recorder_.receive(*message);
  finish();
}

void Recorder::finish() {
  if (recorder_.finished() || !recorder_.finish()) return;
  ROS_INFO_STREAM("recorded " << recorder_.bytes() / 1000000 << " MB");
  publish_progress();
}

// As the monitor does, it reports only when it can hear every vehicle and every channel.
bool Recorder::is_linked() {
  linked_ = linked_ || recorder_.finished() ||
            std::all_of(positions_.begin(), positions_.end(),
                        [](const ros::Subscriber& position) { return position.getNumPublishers() > 0; });
  return linked_;
}

void Recorder::tick() {
  if (is_linked()) publish_progress();
}

void Recorder::publish_progress() {
  acknowledged_ = recorder_.arrivals().acknowledgement();
  const double megabytes = static_cast<double>(recorder_.bytes()) * 1e-6;
  const double seconds = began_ < 0.0 ? 0.0 : now() - began_;
  Progress message;
  message.header.stamp.fromNSec(platoon_time_);
  message.receiver = "recorder";
  message.attempt = acknowledged_.attempt;
  message.first_realization = acknowledged_.first_realization;
  message.step = acknowledged_.step;
  message.finished = recorder_.finished();
  message.note = formatted("bag %.0f MB, %.0f MB/s", megabytes, seconds > 0.0 ? megabytes / seconds : 0.0);
  progress_.publish(message);
}

}  // namespace platoon
