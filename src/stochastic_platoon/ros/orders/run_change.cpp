#include "stochastic_platoon/ros/orders/run_change.hpp"

#include <ros/console.h>
#include <stochastic_platoon/Progress.h>

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/ros/bags/bag_writer.hpp"
#include "stochastic_platoon/ros/messages/topics.hpp"
#include "stochastic_platoon/ros/transport/transport.hpp"
#include "stochastic_platoon/run/configuration/configuration_document.hpp"
#include "stochastic_platoon/run/results/checkpoint.hpp"

namespace platoon {

namespace {

// The settings that a change may have, and what types in the string then inherit from the default vehicle.
const std::map<std::string, bool Inherited::*> kChangeable{{"headway", &Inherited::headway},
                                                           {"noise_variance", &Inherited::noise_variance},
                                                           {"loss", &Inherited::loss_probability}};
constexpr double kAnswerTime = 0.02;  // [s] for the service's answer to be sent

std::string suffix_of(std::uint64_t number) {
  return number == 1 ? "" : "-run" + std::to_string(number);
}

// The name for another run of the same launch: "/tmp/live", "/tmp/live-run2", ...
std::string renamed(std::string stem, std::uint64_t from, std::uint64_t to, const std::string& extension) {
  const auto drop = [&stem](const std::string& end) {
    const bool there = stem.size() > end.size() && stem.compare(stem.size() - end.size(), end.size(), end) == 0;
    if (there) stem.resize(stem.size() - end.size());
  };
  drop(extension);
  drop(suffix_of(from));
  return stem + suffix_of(to) + extension;
}

// A number as text from which the parser restores the same bits; a text unchanged. JSON has no NaN and no infinity.
std::string text_of(const std::string& key, const XmlRpc::XmlRpcValue& value) {
  using Value = XmlRpc::XmlRpcValue;
  if (value.getType() == Value::TypeInt) return std::to_string(static_cast<int>(value));
  if (value.getType() == Value::TypeDouble) {
    const double number = static_cast<double>(value);
    return std::isfinite(number) ? nlohmann::json(number).dump() : formatted("%g", number);
  }
  const bool is_text = value.getType() == Value::TypeString;
  const std::string text = is_text ? static_cast<std::string>(value) : "";
  if (text.empty()) throw ConfigurationError({key + (is_text ? ": empty" : "") + ": must be a number"});
  return text;
}

// The settings in the parameter change_run, which this call removes. Throws ConfigurationError.
std::map<std::string, std::string> taken_parameter(const ros::NodeHandle& platoon) {
  XmlRpc::XmlRpcValue value;
  std::map<std::string, std::string> given;
  if (!platoon.getParam(kChangeRunService, value)) return given;
  platoon.deleteParam(kChangeRunService);
  if (value.getType() != XmlRpc::XmlRpcValue::TypeStruct)
    throw ConfigurationError({"parameter change_run: must be a dictionary, as in {headway: 2.4}"});
  for (auto& entry : value) {
    if (kChangeable.count(entry.first) == 0)
      throw ConfigurationError({entry.first + ": unknown key: allowed are headway, noise_variance, loss"});
    given[entry.first] = text_of(entry.first, entry.second);
  }
  return given;
}

bool is_taken(const RunOptions& run) {
  if (std::filesystem::exists(run.output)) return true;
  return !run.record.empty() && !overwritten(run.record, run.record_split_mb > 0).empty();
}

// Throws ConfigurationError if no vehicle takes one of the settings. `model` has them.
void require_takers(PlatoonModel model, std::size_t followers, const std::map<std::string, std::string>& given) {
  model.string.resize(std::min(model.string.size(), followers));
  ProblemCollector problems;
  for (const auto& [key, value] : given) {
    if (types_with_default(model, kChangeable.at(key)).empty())
      problems.add(key + ": " + value +
                   ": must be left out: no vehicle of the string takes it from the default vehicle");
  }
  problems.require_none();
}

}  // namespace

Configuration changed(const Configuration& present, const std::map<std::string, std::string>& given) {
  if (present.run.averaging() == Averaging::over_realizations) {
    throw ConfigurationError(
        {"steps: " + std::to_string(present.run.steps) +
         ": must be 0 (an endless run, as live.launch's) for a change: statistics over realizations are of one configuration; launch another run instead"});
  }
  Configuration next = parse_configuration(configuration_document(present, given));
  RunOptions& run = next.run;
  require_takers(next.model, run.followers, given);
  run.resume = false;
  do {
    ++run.number;
    run.output = renamed(present.run.output, present.run.number, run.number, "");
    if (!run.record.empty()) run.record = renamed(present.run.record, present.run.number, run.number, ".bag");
  } while (is_taken(run));
  return next;
}

RunChange::RunChange(ros::NodeHandle platoon, const Configuration& present, Begin begin)
    : platoon_(platoon),
      present_(present),
      begin_(std::move(begin)),
      notices_(platoon.advertise<stochastic_platoon::Progress>(kProgressTopic, 10)),
      service_(platoon.advertiseService(kChangeRunService, &RunChange::serve, this)) {}

bool RunChange::serve(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
  try {
    const std::map<std::string, std::string> given = taken_parameter(platoon_);
    const Configuration next = changed(asked_.value_or(present_), given);
    lock_output(next.run)->leave_claim(::getppid());  // roslaunch, or the shell
    // Before the answer: from now on every restarted node takes part in this run.
    platoon_.setParam("configuration", to_json(next).dump());
    response.success = 1;
    response.message = "run " + std::to_string(next.run.number) + " begins";
    for (const auto& entry : given) response.message += ", " + entry.first + " " + entry.second;
    response.message += ": its statistics start anew, results go to " + next.run.output;
    asked_ = next;
    asked_at_ = now();
    ROS_INFO_STREAM(response.message);
  } catch (const std::exception& error) {
    response.message = std::string("change_run: rejected: ") + error.what();
    ROS_WARN_STREAM(response.message);
  }
  return true;
}

void RunChange::begin_if_asked() {
  if (!asked_ || now() - asked_at_ < kAnswerTime) return;
  const Configuration next = *std::exchange(asked_, std::nullopt);
  // On this notice the leader ends the old run at once and waits for the reports of the new one.
  stochastic_platoon::Progress notice;
  notice.receiver = kChangeRunService;
  notice.run = run_identity(next);
  notice.step = kNothingYet;
  notice.notice = stochastic_platoon::Progress::BEGINS;
  notices_.publish(notice);
  begin_(next);
}

}  // namespace platoon
