#include "stochastic_platoon/graph/recorder.hpp"

#include <ros/console.h>

#include <boost/function.hpp>

#include "stochastic_platoon/graph/transport.hpp"
#include "stochastic_platoon/io/text.hpp"
#include "stochastic_platoon/messages/position.hpp"
#include "stochastic_platoon/messages/topics.hpp"

namespace platoon {

using stochastic_platoon::ErrorStatistics;
using stochastic_platoon::Position;

namespace {

std::string parent_of(const std::string& name) {
  return name.substr(0, name.rfind('/'));
}

}  // namespace

Recorder::Recorder(ros::NodeHandle platoon, const Configuration& configuration,
                   RunMembership::Join superseded)
    : membership_(platoon, "recorder", run_identity(configuration), std::move(superseded)),
      recording_(configuration, parent_of(platoon.resolveName(kConfigurationTopic))),
      reports_(platoon, "recorder", configuration) {
  for (std::size_t s = 0; s < recording_.streams(); ++s) drops_.emplace_back(recording_.topic(s));
  for (std::size_t s = 0; s < recording_.streams(); ++s) {
    const boost::function<void(const Position::ConstPtr&)> callback =
        [this, s](const Position::ConstPtr& message) { receive(s, message); };
    positions_.push_back(platoon.subscribe<Position>(recording_.topic(s), kUnboundedQueue, callback,
                                                     ros::VoidConstPtr(), no_delay()));
  }
  error_statistics_ = platoon.subscribe(kErrorStatisticsTopic, kUnboundedQueue, &Recorder::receive_statistics,
                                        this, no_delay());
  timer_ = platoon.createSteadyTimer(ros::WallDuration(kHeartbeat), [this](const auto&) { tick(); });
}

void Recorder::receive(std::size_t stream, const Position::ConstPtr& message) {
  const MessageId id = id_of(*message);
  const std::size_t size = message->position.size();
  if (!membership_.admits(message->run)) return drops_[stream].count(Verdict::foreign_run, id, size);
  reports_.saw(message->header.stamp.toNSec());
  const Verdict verdict = recording_.receive(stream, message);
  if (verdict != Verdict::in_turn) return drops_[stream].count(verdict, id, size);
  if (!began_) began_ = now();
  reports_.report_if_due(recording_.arrivals());
  finish();
}

void Recorder::receive_statistics(const ErrorStatistics::ConstPtr& message) {
  recording_.receive(*message);
  finish();
}

void Recorder::finish() {
  if (!recording_.ready_to_finish()) return;
  if (recording_.holds_given_up())
    ROS_INFO("writing the bag once more, without the attempts that were given up");
  recording_.finish();
  ROS_INFO_STREAM("recorded " << recording_.bytes() / 1000000 << " MB");
  reports_.set_finished();
  report();
}

void Recorder::tick() {
  if (recording_.finished() || reports_.is_linked(positions_)) report();
}

void Recorder::report() {
  const double megabytes = static_cast<double>(recording_.bytes()) * 1e-6;
  const double seconds = began_ ? now() - *began_ : 0.0;
  reports_.set_note(
      formatted("bag %.0f MB, %.0f MB/s", megabytes, seconds > 0.0 ? megabytes / seconds : 0.0));
  reports_.report(recording_.arrivals());
}

}  // namespace platoon
