#include "stochastic_platoon/ros/observation/stall_reporter.hpp"

#include <stochastic_platoon/Progress.h>

#include <algorithm>
#include <tuple>
#include <utility>

#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/ros/transport/transport.hpp"
#include "stochastic_platoon/run/delivery/pipeline.hpp"
#include "stochastic_platoon/run/delivery/vehicle_contract.hpp"
#include "stochastic_platoon/run/delivery/vehicle_name.hpp"

namespace platoon {

using stochastic_platoon::Progress;

namespace {

constexpr double kStartTime = 0.05;           // [s] per vehicle, from launch to its first message
constexpr double kStallWithoutTimeout = 2.0;  // [s] until a stall is reported, if the leader never retries
constexpr double kSettled = 0.3;              // [s] without a message until the progress of an attempt is examined

}  // namespace

void StallReporter::receive(const std::string& component, Notice notice) {
  const bool room = notices_.size() <= run_.followers + run_.receivers().size();
  if (room || notices_.count(component) > 0) notices_[component] = std::move(notice);
}

std::string StallReporter::text_of(const std::string& component) const {
  const auto found = notices_.find(component);
  return found == notices_.end() ? "" : found->second.text;
}

// A blocked attempt brings messages, too. Progress is a larger number of messages than in any attempt since the latest
// complete step.
void StallReporter::note_arrival(const Arrivals& arrivals, double present) {
  last_message_ = present;
  const std::uint64_t messages = arrivals.messages();
  if (messages > most_messages_) {
    most_messages_ = messages;
    watch_.arrived(present);
  }
  const Acknowledgement report = arrivals.acknowledgement();
  const bool step = report.step != kNothingYet || report.first_realization > complete_.first_realization;
  const bool new_step = step && std::tie(report.attempt, report.first_realization, report.step) !=
                                    std::tie(complete_.attempt, complete_.first_realization, complete_.step);
  if (new_step) {
    most_messages_ = messages;
    watch_.completed_step(present);
  }
  complete_ = report;
}

StallReporter::Change StallReporter::look(const Observation& seen, double present) {
  const double pace = run_.rate > 0.0 ? 1.0 / run_.rate + (seen.began ? 0.0 : kObserverTime) : 0.0;
  const double start = seen.began ? 0.0 : kStartTime * static_cast<double>(run_.followers);
  const double patience = run_.stall_timeout > 0.0 ? run_.stall_timeout : kStallWithoutTimeout;
  const StallWatch::Change change = watch_.look(present, 0.75 * patience + pace + start);
  if (change == StallWatch::Change::moving) {
    const std::string moving = formatted(", after %.1f s and %u retries", present - since_, retries(seen.arrivals));
    culprit_.reset();
    notices_.clear();
    return {"", moving};
  }
  if (change == StallWatch::Change::stalled) {
    culprit_ = diagnose(seen);
    since_ = *watch_.last_arrival();
    first_attempt_ = seen.arrivals.attempt();
    return {culprit_->text, ""};
  }
  if (!watch_.stalled() || present - last_message_ <= kSettled) return {};
  const std::optional<StallDiagnosis> before = std::exchange(culprit_, diagnose(seen));
  return {before && culprit_->is_that_of(*before) ? "" : culprit_->text, ""};
}

std::string StallReporter::start(const std::vector<std::size_t>& missing, const Arrivals& arrivals) const {
  const auto is_external = [this](std::size_t vehicle) { return run_.is_external(vehicle); };
  if (!missing.empty() && std::all_of(missing.begin(), missing.end(), is_external)) {
    return "waiting for external " + vehicle_name(missing[0]) + ": start its node" +
           (missing.size() > 1 ? formatted(" (and %zu more external vehicles)", missing.size() - 1) : std::string());
  }
  if (!missing.empty()) return formatted("waiting for %zu of %zu vehicles", missing.size(), run_.followers + 1);
  const auto share = static_cast<double>(arrivals.messages()) /
                     static_cast<double>(messages_of_first_step(run_.followers, run_.pipeline_depth(), run_.steps));
  return formatted("first step: %.0f %%", 100.0 * std::min(share, 1.0));
}

StallDiagnosis StallReporter::diagnose(const Observation& seen) const {
  const std::vector<std::size_t> missing = seen.missing();
  if (!missing.empty()) return of_missing(missing);
  const std::vector<std::size_t> mute = seen.mute();
  if (!mute.empty()) return of_mute(mute.front());
  if (const std::optional<StallDiagnosis> receiver = of_receivers(seen.arrivals)) return *receiver;
  const auto of_vehicles = [this](std::vector<std::optional<MessageId>> streams) {
    streams.resize(run_.followers + 1);  // inputs follow the positions
    return streams;
  };
  StallDiagnosis found = diagnose_stall(of_vehicles(seen.arrivals.latest()), run_.schedule(), run_.pipeline_depth(),
                                        run_.external, of_vehicles(seen.arrivals.latest_of_any_attempt()));
  if (found.vehicle) found.text += explanation_of(*found.vehicle, seen.arrivals) + breach_of(*found.vehicle, seen);
  return found;
}

StallDiagnosis StallReporter::of_missing(const std::vector<std::size_t>& missing) const {
  const std::string name = vehicle_name(missing.front());
  const bool external = run_.is_external(missing.front());
  const std::string text =
      missing.size() > 1 ? std::to_string(missing.size()) + " of " + std::to_string(run_.followers + 1) +
                               " vehicles are not running, the first of them " + name
                         : name + (external ? " is external and not running: start its node; " : " is not running: ") +
                               "no publisher of " + topics_.at(missing.front());
  return {StallCause::not_running, missing.front(), text};
}

StallDiagnosis StallReporter::of_mute(std::size_t vehicle) const {
  const std::string name = vehicle_name(vehicle), follower = vehicle_name(vehicle + 1);
  return {StallCause::no_input, vehicle,
          name + (run_.is_external(vehicle) ? " is external and" : "") + " publishes no " + name + "/input, which " +
              follower + " receives by radio: it must publish its control input, or " + follower +
              " must have no radio"};
}

// The receivers beside the monitor. The leader sends nothing before the first report of each.
std::optional<StallDiagnosis> StallReporter::of_receivers(const Arrivals& arrivals) const {
  for (const auto& [component, notice] : notices_) {
    if (notice.kind == Progress::BLOCKED)
      return StallDiagnosis{StallCause::blocked_receiver, {}, component + " blocks the run: " + notice.text};
  }
  if (arrivals.latest_of_any_attempt().front()) return std::nullopt;
  for (const std::string& receiver : run_.receivers()) {
    if (receiver != "monitor" && notices_.count(receiver) == 0)
      return StallDiagnosis{
          StallCause::silent_receiver, {}, receiver + " has not reported, and the leader waits for it"};
  }
  return std::nullopt;
}

// The vehicle's notice, if it refers to this run as a whole or to the present attempt.
std::string StallReporter::explanation_of(std::size_t vehicle, const Arrivals& arrivals) const {
  const auto found = notices_.find(vehicle_name(vehicle));
  if (found == notices_.end()) return "";
  const Notice& notice = found->second;
  const bool is_present = notice.kind == Progress::REJECTED || notice.attempt == arrivals.attempt();
  return is_present ? "; it reports: " + notice.text : "";
}

// The contract clause that a blocking external vehicle violates.
std::string StallReporter::breach_of(std::size_t vehicle, const Observation& seen) const {
  if (!run_.is_external(vehicle)) return "";
  const std::optional<DropReason> breach = seen.breach(vehicle);
  const std::string dropped =
      breach ? std::string("its last message was dropped, as ") + to_string(*breach) + "; " : "";
  return "; the vehicle is external: " + dropped + named(breach ? *broken_clause(*breach) : Clause::answer);
}

}  // namespace platoon
