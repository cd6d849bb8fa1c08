#include "stochastic_platoon/ros/transport/run_membership.hpp"

#include <ros/callback_queue.h>
#include <ros/console.h>
#include <ros/init.h>
#include <stochastic_platoon/Progress.h>
#include <boost/make_shared.hpp>

#include <chrono>
#include <thread>
#include <utility>

#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/ros/messages/topics.hpp"
#include "stochastic_platoon/ros/transport/progress_reports.hpp"
#include "stochastic_platoon/ros/transport/transport.hpp"

namespace platoon {

namespace {

constexpr double kLookPeriod = 0.2;           // [s] between checks for the same unknown run
constexpr double kShortestLookPeriod = 0.05;  // [s] for any

// A function as an entry of a callback queue.
class Call : public ros::CallbackInterface {
public:
  explicit Call(std::function<void()> function) : function_(std::move(function)) {}
  CallResult call() override {
    function_();
    return Success;
  }

private:
  std::function<void()> function_;
};

std::string shown(std::uint64_t run) {
  return formatted("%016llx", static_cast<unsigned long long>(run));
}

}  // namespace

std::optional<Configuration> read_configuration(const ros::NodeHandle& platoon) {
  std::string text;
  if (!platoon.hasParam("configuration")) return std::nullopt;
  if (!platoon.getParam("configuration", text)) {
    throw ConfigurationError(
        {platoon.resolveName("configuration") + ": must be a text, the output of configure (platoon.launch sets it)"});
  }
  return parse_configuration(text);
}

std::optional<Configuration> wait_for_configuration(const ros::NodeHandle& platoon) {
  while (ros::ok()) {
    std::optional<Configuration> found = read_configuration(platoon);
    if (found) return found;
    ROS_WARN_STREAM_THROTTLE(10.0, "waiting for the parameter "
                                       << platoon.resolveName("configuration")
                                       << ": platoon.launch sets it; launch again if the master was restarted");
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
  }
  return std::nullopt;
}

RunMembership::RunMembership(const ros::NodeHandle& platoon, std::string name, std::uint64_t run, Join join)
    : platoon_(platoon), name_(std::move(name)), join_(std::move(join)), run_(run) {}

RunMembership::~RunMembership() {
  ros::getGlobalCallbackQueue()->removeByID(reinterpret_cast<std::uint64_t>(this));
}

void RunMembership::join(const Configuration& configuration) {
  if (join_(configuration)) {
    run_ = run_identity(configuration);
  } else {
    over_ = true;
  }
}

bool RunMembership::looks_and_admits(std::uint64_t run) {
  const std::lock_guard<std::mutex> lock(looking_);
  if (run == run_) return true;
  if (over_) return false;
  const double present = now();
  const double period = run == last_unknown_ ? kLookPeriod : kShortestLookPeriod;
  if (last_look_ && present - *last_look_ < period) return false;
  last_unknown_ = run;
  last_look_ = present;
  try {
    const std::optional<Configuration> configuration = read_configuration(platoon_);
    if (!configuration) {
      reject(run, "the parameter " + platoon_.resolveName("configuration") + " is missing");
    } else if (run_identity(*configuration) != run) {
      reject(run, run_identity(*configuration) == run_
                      ? "the platoon's run is " + shown(run_)
                      : "the configuration that " + name_ + " reads is of run " + shown(run_identity(*configuration)));
    } else {
      join(*configuration);
      last_reason_.clear();
    }
  } catch (const std::exception& error) {
    reject(run, error.what());
  }
  return run == run_;
}

// Reports each run and reason once, also to the monitor: a follower has no other way to its terminal.
void RunMembership::reject(std::uint64_t run, const std::string& reason) {
  const std::string text = name_ + " does not take part in run " + shown(run) + ": " + reason;
  if (text == last_reason_) return;
  last_reason_ = text;
  ROS_WARN_STREAM(text);
  notify(stochastic_platoon::Progress::REJECTED, run, 0, reason);
}

void RunMembership::notify_missed(std::uint32_t attempt) {
  if (missed_ == std::make_pair(run(), attempt)) return;
  missed_ = {run(), attempt};
  notify(stochastic_platoon::Progress::MISSED, run(), attempt,
         "has missed messages of attempt " + std::to_string(attempt));
}

void RunMembership::notify(std::uint8_t kind, std::uint64_t run, std::uint32_t attempt, const std::string& note) {
  stochastic_platoon::Progress notice;
  notice.receiver = name_;
  notice.run = run;
  notice.attempt = attempt;
  notice.step = kNothingYet;
  notice.notice = kind;
  notice.note = note;
  // In the node's own thread: the receiving thread may hold roscpp locks that must not be taken before those of
  // advertise.
  const auto publish = [this, notice] {
    if (!notices_) notices_ = platoon_.advertise<stochastic_platoon::Progress>(kProgressTopic, 10, true);
    notices_.publish(notice);
  };
  ros::getGlobalCallbackQueue()->addCallback(boost::make_shared<Call>(publish), reinterpret_cast<std::uint64_t>(this));
}

}  // namespace platoon
