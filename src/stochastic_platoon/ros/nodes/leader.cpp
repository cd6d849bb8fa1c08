#include "stochastic_platoon/ros/nodes/leader.hpp"

#include <ros/console.h>

#include <algorithm>
#include <stdexcept>

#include "stochastic_platoon/ros/messages/position.hpp"
#include "stochastic_platoon/ros/messages/topics.hpp"
#include "stochastic_platoon/ros/transport/progress_reports.hpp"
#include "stochastic_platoon/ros/transport/transport.hpp"
#include "stochastic_platoon/run/io/printable.hpp"

namespace platoon {

using stochastic_platoon::Position;
using stochastic_platoon::Progress;

namespace {

// Timeout of an attempt's first step [s]. The step passes from vehicle to vehicle, and each may touch its memory for
// the first time. Credit increases the timeout if necessary.
double first_step_timeout(const RunOptions& run) {
  constexpr double kForAll = 0.1;        // [s]
  constexpr double kPerVehicle = 0.01;   // [s]
  constexpr double kPerPosition = 5e-7;  // [s]
  const auto followers = static_cast<double>(run.followers);
  const double sought = kForAll + followers * (kPerVehicle + kPerPosition * static_cast<double>(run.batch));
  return run.stall_timeout > 0.0 ? std::min(sought, run.stall_timeout) : sought;
}

constexpr double kWatchPeriod = 0.02;  // [s]

}  // namespace

Leader::Leader(ros::NodeHandle platoon, const Configuration& configuration, RunMembership::Join superseded)
    : platoon_(platoon),
      run_(configuration.run),
      schedule_(run_.schedule()),
      paced_(run_.rate > 0.0),
      superseded_(std::move(superseded)),
      membership_(platoon, "vehicle_0", 0, [this](const Configuration& joined) { return begin(joined); }),
      notice_senders_(platoon, configuration.model),
      published_(platoon.resolveName(position_topic(0))),
      position_(platoon.advertise<Position>(position_topic(0), kUnboundedQueue)),
      orders_(platoon, [this]() -> Manoeuvre& { return manoeuvre(); }) {
  if (sends_input(configuration.model, 0, run_.followers))
    input_ = platoon.advertise<Position>(input_topic(0), kUnboundedQueue);
  membership_.join(configuration);
  progress_ = platoon.subscribe(kProgressTopic, kUnboundedQueue, &Leader::receive, this, no_delay());
  stall_timer_ = platoon.createSteadyTimer(ros::WallDuration(kWatchPeriod), [this](const auto&) { watch(); });
  if (paced_) {
    pace_timer_ = platoon.createSteadyTimer(ros::WallDuration(1.0 / run_.rate), [this](const auto&) { publish_one(); });
  }
}

bool Leader::begin(const Configuration& configuration) {
  const RunOptions& run = configuration.run;
  if (run.batch != run_.batch || run.rate != run_.rate || run.receivers() != run_.receivers() ||
      sends_input(configuration.model, 0, run.followers) != input_.has_value()) {
    return superseded_(configuration);
  }
  run_ = run;
  schedule_ = run.schedule();
  run_state_.emplace(
      RunState{Credit(schedule_, {run.window, run.stall_timeout, first_step_timeout(run)}, run.receivers()),
               LeaderVehicle(configuration.model),
               platoon_period(configuration.model.sample_period),
               paced_ && run.number == 1,
               {}});
  for (const std::string& name : run.receivers())
    run_state_->reporters.emplace(name, SolePublisher(platoon_.resolveName(kProgressTopic) + " of " + name));
  return true;
}

Manoeuvre& Leader::manoeuvre() {
  if (run_.averaging() == Averaging::over_realizations) {
    throw std::runtime_error(
        "rejected: in a run of many realizations the leader drives by the model file (leader/speed there); an endless run (live.launch, steps:=0) accepts orders");
  }
  return run_state_->vehicle.manoeuvre();
}

void Leader::receive(const ProgressEvent& event) {
  const Progress::ConstPtr message = event.getMessage();
  if (!membership_.admits(message->run) || membership_.is_over()) return;
  const Acknowledgement report{message->attempt, message->first_realization, message->step};
  const auto reporter = run_state_->reporters.find(message->receiver);
  if (reporter == run_state_->reporters.end()) return receive_notice(event);
  if (!reporter->second.admits(event.getConnectionHeaderPtr(), message->run)) return;
  if (!may_be_reported(schedule_, report)) {
    ROS_WARN_STREAM_THROTTLE(1.0, "progress: ignored a report of \""
                                      << reporter->first << "\" beyond this run: attempt " << report.attempt
                                      << ", realizations from " << report.first_realization << ", step "
                                      << report.step);
    return;
  }
  if (message->notice == Progress::BLOCKED) {  // it gives no credit
    run_state_->holding.insert(message->receiver);
    return;
  }
  run_state_->credit.acknowledge(message->receiver, report, now(), message->messages);
  run_state_->holding.erase(message->receiver);
  if (run_state_->waits_for_observers && run_state_->credit.attempt() == 0 && message->attempt == 0 &&
      !run_state_->begin)
    run_state_->begin = now() + kObserverTime;
  // After a restart, stamps continue after those of all messages that may still be in flight.
  ros::Time seen = message->header.stamp;
  if (run_state_->credit.attempt() == 0 && !seen.isZero()) {
    for (std::int64_t step = 0; step <= run_.window; ++step) seen = later(seen, run_state_->period);
    run_state_->stamp = std::max(run_state_->stamp, seen);
  }
  publish_allowed();
}

// From a component that is no receiver.
void Leader::receive_notice(const ProgressEvent& event) {
  const Progress& notice = *event.getConstMessage();
  if (notice.notice == Progress::NONE) {
    ROS_WARN_STREAM_THROTTLE(1.0, "progress: ignored a report from \"" << printable(shortened(notice.receiver))
                                                                       << "\": it is no receiver of this run");
  }
  if (notice.notice != Progress::MISSED) return;  // the monitor reports the others
  if (!run_state_->credit.may_give_up(notice.attempt, now()) || !notice_senders_.admits(event)) return;
  run_state_->credit.give_up(notice.attempt, now());
  ROS_INFO_STREAM(notice.receiver << " has missed messages of attempt " << notice.attempt << ": attempt "
                                  << run_state_->credit.attempt() << " begins");
  publish_allowed();
}

void Leader::watch() {
  // A retry is useless while a receiver is blocked.
  if (run_state_->holding.empty() && run_state_->credit.retry_if_stalled(now())) {
    ROS_DEBUG_STREAM("no progress: attempt " << run_state_->credit.attempt() << " begins");
  }
  publish_allowed();
  window_ = run_.window;
  unacknowledged_ = run_state_->credit.unacknowledged();
}

Diagnostics::Fill Leader::status() const {
  return [this, signs = VitalSigns({&published_})](diagnostic_updater::DiagnosticStatusWrapper& status) mutable {
    signs(status);
    status.add("credit", std::to_string(window_.get() - unacknowledged_.get()) + " of " +
                             std::to_string(window_.get()) + " steps");
    status.add("unacknowledged steps", unacknowledged_.get());
  };
}

void Leader::publish_allowed() {
  while (!paced_ && publish_one()) {
  }
}

bool Leader::publish_one() {
  if (membership_.is_over() || (run_state_->begin && now() < *run_state_->begin)) return false;
  const std::optional<MessageId> id = run_state_->credit.next(now());
  if (!id) return false;
  published_.take(*id);
  const bool begins_again = id->step == kInitialStep && !run_state_->stamp.isZero();
  run_state_->stamp = later(run_state_->stamp, run_state_->period);
  if (begins_again && run_state_->vehicle.manoeuvre().is_under_way())
    ROS_WARN("the platoon begins again: the leader's manoeuvre is over");
  const double position = id->step == kInitialStep ? run_state_->vehicle.start() : run_state_->vehicle.step();
  send(position_, *id, position);
  if (input_) send(*input_, *id, run_state_->vehicle.input());
  return true;
}

void Leader::send(const ros::Publisher& topic, const MessageId& id, double value) {
  const auto message = messages_.take();
  message->header.stamp = run_state_->stamp;
  set_id(membership_.run(), id, *message);
  message->position.assign(schedule_.size(id.first_realization), value);
  platoon::publish(topic, message);
}

}  // namespace platoon
