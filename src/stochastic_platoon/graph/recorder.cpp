#include "stochastic_platoon/graph/recorder.hpp"

#include <ros/console.h>

#include <boost/function.hpp>

#include "stochastic_platoon/graph/wire.hpp"
#include "stochastic_platoon/results/text.hpp"

namespace platoon {

using stochastic_platoon::ErrorStatistics;
using stochastic_platoon::Position;

namespace {

std::string parent_of(const std::string& name) {
  return name.substr(0, name.rfind('/'));
}

}  // namespace

Recorder::Recorder(ros::NodeHandle platoon, const Configuration& configuration)
    : recorder_(configuration, parent_of(platoon.resolveName("configuration"))),
      reports_(platoon, "recorder", configuration.run) {
  for (std::size_t s = 0; s < recorder_.streams(); ++s) refusals_.emplace_back(recorder_.topic(s));
  for (std::size_t s = 0; s < recorder_.streams(); ++s) {
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
  reports_.saw(message->header.stamp.toNSec());
  const Verdict verdict = recorder_.receive(stream, message);
  if (verdict != Verdict::in_turn) {
    const Turn turn = turn_of(*message);
    return refusals_[stream].count(verdict, turn, message->position.size());
  }
  if (began_ < 0.0) began_ = now();
  reports_.report_if_due(recorder_.arrivals().acknowledgement());
  finish();
}

void Recorder::receive_statistics(const ErrorStatistics::ConstPtr& message) {
  recorder_.receive(*message);
  finish();
}

void Recorder::finish() {
  if (!recorder_.ready_to_finish()) return;
  if (recorder_.holds_given_up())
    ROS_INFO("writing the bag once more, without the attempts that were given up");
  recorder_.finish();
  ROS_INFO_STREAM("recorded " << recorder_.bytes() / 1000000 << " MB");
  reports_.set_finished();
  report();
}

void Recorder::tick() {
  if (recorder_.finished() || reports_.is_linked(positions_)) report();
}

void Recorder::report() {
  const double megabytes = static_cast<double>(recorder_.bytes()) * 1e-6;
  const double seconds = began_ < 0.0 ? 0.0 : now() - began_;
  reports_.set_note(
      formatted("bag %.0f MB, %.0f MB/s", megabytes, seconds > 0.0 ? megabytes / seconds : 0.0));
  reports_.report(recorder_.arrivals().acknowledgement());
}

}  // namespace platoon
