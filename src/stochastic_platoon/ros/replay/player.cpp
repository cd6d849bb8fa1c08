#include "stochastic_platoon/ros/replay/player.hpp"

#include <ros/console.h>

#include <algorithm>
#include <cmath>

#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/ros/bags/bag_statistics.hpp"
#include "stochastic_platoon/ros/messages/position.hpp"
#include "stochastic_platoon/ros/transport/transport.hpp"

namespace platoon {

using stochastic_platoon::Position;
using stochastic_platoon::Progress;

namespace {

constexpr double kIdlePeriod = 0.005;      // [s] between checks of the clock without other events
constexpr double kMonitorPatience = 1.0;   // [s] without progress
constexpr unsigned kMostRepetitions = 10;  // that complete no batch

bool is_played(const PlatoonTopic& topic) {
  return topic.kind == PlatoonTopic::Kind::position || topic.kind == PlatoonTopic::Kind::input ||
         topic.kind == PlatoonTopic::Kind::error_statistics;
}

}  // namespace

Player::Player(ros::NodeHandle platoon, ros::NodeHandle private_node, const Configuration& configuration,
               const PlayerOptions& options)
    : run_(run_identity(configuration)),
      schedule_(configuration.run.schedule()),
      window_(configuration.run.window),
      options_(options),
      stream_(std::in_place, options.bags, is_played),
      reading_(recorded_platoon(options.bags)),
      upcoming_(next()),
      paused_at_(options.paused ? std::optional<double>(now()) : std::nullopt) {
  for (std::size_t i = 0; i <= configuration.run.followers; ++i) {
    played_[{PlatoonTopic::Kind::position, i}] = platoon.advertise<Position>(position_topic(i), kUnboundedQueue);
  }
  for (const std::size_t i : measured_followers(configuration))
    played_[{PlatoonTopic::Kind::input, i}] = platoon.advertise<Position>(input_topic(i), kUnboundedQueue);
  if (upcoming_) first_stamp_ = upcoming_->position()->header.stamp;
  if (const std::uint64_t first = upcoming_ ? upcoming_->position()->first_realization : 0; first > 0) {
    throw BagError(
        options_.bags.files.front() + ": begins with realization " + std::to_string(first) +
        ", as that of a resumed run, or without the first part: must begin with realization 0 to be replayed into a monitor (bag_statistics reads it)");
  }
  const boost::function<bool(std_srvs::SetBool::Request&, std_srvs::SetBool::Response&)> set_paused =
      [this](std_srvs::SetBool::Request& request, std_srvs::SetBool::Response& response) {
        if (began_ && paused_at_ && !request.data) *began_ += now() - *paused_at_;
        if (!request.data) paused_at_.reset();
        if (request.data && !paused_at_) paused_at_ = now();
        last_progress_ = now();
        response.success = true;
        response.message = request.data ? "paused" : "playing";
        return true;
      };
  pause_ = private_node.advertiseService("pause_playback", set_paused);
  progress_ = platoon.subscribe(kProgressTopic, kUnboundedQueue, &Player::receive, this, no_delay());
  timer_ = platoon.createSteadyTimer(ros::WallDuration(kIdlePeriod), [this](const auto&) { play(); });
}

void Player::receive(const Progress::ConstPtr& message) {
  if (message->run != run_ || message->receiver != "monitor") return;
  const Acknowledgement report{0, message->first_realization, message->step};
  if (!may_be_reported(schedule_, report)) return;
  heard_ = true;
  if (message->notice == Progress::MISSED) {
    is_behind_ = true;
    return play();
  }
  const std::int64_t acknowledged = steps_covered(schedule_, 0, report);
  // Each attempt of an endless recording begins with step -1 again.
  if (schedule_.endless() && acknowledged < acknowledged_ && message->attempt <= reported_attempt_) {
    throw BagError(options_.bags.files.front() +
                   ": the monitor was started again and has lost its place in an endless recording: replay it again");
  }
  reported_attempt_ = message->attempt;
  if (acknowledged != acknowledged_) {
    is_behind_ = acknowledged < acknowledged_;
    granted_ = 0;
    last_progress_ = now();
  }
  if (report.first_realization > committed_) repetitions_ = 0;
  acknowledged_ = acknowledged;
  committed_ = report.first_realization;
  play();
}

// [s]. Negative if all nodes of the recorded run were killed at once: the platoon time then goes back. A ros::Duration
// would throw beyond 68 years, and the stamps of a bag may be further apart.
double Player::since_first(const Position& message) const {
  return message.header.stamp.toSec() - first_stamp_.toSec();
}

// Exceeds the window, by another one at a time, only where the monitor may wait in vain: the attempts that a plain
// `rosbag record` or an endless recording holds besides the last one cannot complete.
bool Player::may_publish(const Position& message) {
  if (options_.rate > 0.0) {
    const double due = since_first(message) - options_.start;
    if (now() - *began_ < due / options_.rate) return false;
  }
  if (is_within_window(message)) return true;
  if (!options_.bags.unverified && !schedule_.endless()) return false;
  if (now() - std::max(last_progress_, last_published_) <= kMonitorPatience) return false;
  granted_ = steps_covered(schedule_, 0, id_of(message));
  return true;
}

bool Player::is_within_window(const Position& message) const {
  // The monitor takes a newer attempt only where it has committed all batches before it.
  const bool begins_attempt = message.attempt + attempts_ahead_ > last_attempt_;
  if (begins_attempt && !schedule_.endless() && message.first_realization > committed_) return false;
  return steps_covered(schedule_, 0, id_of(message)) <= std::max(acknowledged_, granted_) + window_;
}

void Player::play() {
  if (!heard_ || paused_at_) return;
  if (!began_) began_ = last_progress_ = now();
  if (is_lost()) begin_again();
  while (upcoming_ && may_publish(*upcoming_->position())) {
    const auto played = played_.find({upcoming_->topic.kind, upcoming_->topic.vehicle});
    const Position::Ptr position = upcoming_->position();
    const bool left_out = position->first_realization < resumes_at_;
    reading_->take(*upcoming_);
    upcoming_ = next();
    if (!upcoming_) require_as_recorded();
    if (played == played_.end() || left_out) continue;
    position->run = run_;
    position->attempt += attempts_ahead_;
    last_attempt_ = std::max(last_attempt_, position->attempt);
    last_published_ = now();
    played->second.publish(position);
  }
}

// Whether the monitor needs messages again. The attempts that a plain `rosbag record` has abandoned look like losses
// until all of it is played.
bool Player::is_lost() const {
  if (schedule_.endless() || schedule_.is_complete(committed_)) return false;
  const double waited_since = now() - kMonitorPatience * std::pow(1.5, repetitions_);
  if (last_progress_ > waited_since) return false;
  if (!options_.bags.unverified && is_behind_) return true;
  const bool waits = !upcoming_ || (!options_.bags.unverified && !is_within_window(*upcoming_->position()));
  return waits && last_published_ <= waited_since;
}

void Player::begin_again() {
  if (++repetitions_ > kMostRepetitions) {
    throw BagError(options_.bags.files.front() + ": the monitor has not completed the realizations from " +
                   std::to_string(committed_) + " in " + std::to_string(kMostRepetitions) + " repetitions");
  }
  is_behind_ = false;
  granted_ = 0;
  resumes_at_ = committed_;
  stream_.emplace(options_.bags, is_played);
  reading_.emplace(recorded_platoon(options_.bags));
  upcoming_ = next();
  if (!upcoming_) throw BagError(options_.bags.files.front() + ": has changed while it was replayed");
  attempts_ahead_ = last_attempt_ + 1 - upcoming_->position()->attempt;
  last_progress_ = now();
  ROS_INFO_STREAM("the monitor has lost messages: the replay begins again with realization " << resumes_at_);
}

// The next position or input. Statistics before it are kept for the comparison at the end.
std::optional<RecordedMessage> Player::next() {
  std::optional<RecordedMessage> message = stream_->next();
  for (; message && message->topic.kind == PlatoonTopic::Kind::error_statistics; message = stream_->next())
    reading_->take(*message);
  return message;
}

void Player::require_as_recorded() const {
  const std::vector<std::string> changed = reading_->changed_figures();
  if (!changed.empty()) throw BagError(options_.bags.files.front() + ": error_statistics: " + changed.front());
}

}  // namespace platoon
