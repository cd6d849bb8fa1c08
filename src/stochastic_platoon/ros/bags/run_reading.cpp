#include "stochastic_platoon/ros/bags/run_reading.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "stochastic_platoon/ros/messages/position.hpp"

namespace platoon {

using stochastic_platoon::ErrorStatistics;
using stochastic_platoon::Position;

namespace {

constexpr std::size_t kFindingsPerTopic = 3;

std::string named(const MessageId& id) {
  return "step " + std::to_string(id.step) + " of the realizations from " + std::to_string(id.first_realization);
}

std::string described(DropReason drop, const MessageId& id, const std::optional<MessageId>& before) {
  if (drop != DropReason::out_of_turn || !before) return named(id) + " is " + to_string(drop);
  const bool again =
      std::make_pair(id.first_realization, id.step) <= std::make_pair(before->first_realization, before->step);
  return again ? named(id) + " comes twice"
               : named(id) + " follows " + named(*before) + ": the messages between are missing";
}

bool is_same(double a, double b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

}  // namespace

RunReading::RunReading(const RecordedPlatoon& platoon, const std::optional<std::vector<std::string>>& signals)
    : platoon_(platoon),
      run_(run_identity(platoon.configuration)),
      measured_(measured_followers(platoon.configuration)) {
  if (!signals) return;
  RunOptions& run = platoon_.configuration.run;
  if (!signals->empty() && run.averaging() == Averaging::over_time)
    throw ConfigurationError(
        {"signals: " + signals->front() + ": must be empty for a recording of averages over time"});
  run.signals = *signals;
  const std::vector<std::string> problems = signal_problems(platoon_.configuration);
  if (!problems.empty()) throw ConfigurationError(problems);
  const std::vector<std::size_t> recorded = std::exchange(measured_, measured_followers(platoon_.configuration));
  if (!std::includes(recorded.begin(), recorded.end(), measured_.begin(), measured_.end()))
    throw ConfigurationError({"signals: input: must be absent for a recording of a run without this signal"});
}

void RunReading::take(const RecordedMessage& message) {
  if (message.topic.name_space != platoon_.name_space) return;
  if (message.topic.kind < PlatoonTopic::Kind::error_statistics) return take_values(message.topic, message.position());
  const auto& figures = std::get<ErrorStatistics::Ptr>(message.content);
  if (!figures->time_average && figures->realizations == platoon_.configuration.run.realizations)
    figures_[figures->step] = figures;
}

void RunReading::take_values(const PlatoonTopic& topic, const Position::ConstPtr& message) {
  const bool is_input = topic.kind == PlatoonTopic::Kind::input;
  const std::string name = is_input ? input_topic(topic.vehicle) : position_topic(topic.vehicle);
  const auto measured = std::find(measured_.begin(), measured_.end(), topic.vehicle);
  if (is_input && measured == measured_.end()) return;
  const std::size_t stream =
      is_input ? platoon_.configuration.run.followers + 1 + static_cast<std::size_t>(measured - measured_.begin())
               : topic.vehicle;
  if (topic.vehicle > platoon_.configuration.run.followers) return find(name, "is no vehicle of the recorded platoon");
  const MessageDescriptor descriptor = descriptor_of(*message);
  if (message->run != run_) return find(name, described(DropReason::foreign_run, descriptor.id, std::nullopt));
  if (!statistics_) {
    if (descriptor.id.step != kInitialStep) return;  // of an attempt whose start was missed
    statistics_ = std::make_unique<RunStatistics>(platoon_.configuration, descriptor.id.first_realization);
    if (descriptor.id.first_realization > platoon_.configuration.run.first_realization)
      findings_.push_back("begins with " + named(descriptor.id) + ": the messages before are missing");
  }
  statistics_->saw(message->header.stamp.toNSec());
  const std::optional<MessageId> before = statistics_->arrivals().latest(stream);
  const DropReason drop = statistics_->take(stream, descriptor, positions_of(message));
  if (drop != DropReason::none && drop != DropReason::stale) find(name, described(drop, descriptor.id, before));
}

BagStatistics RunReading::statistics() {
  if (!statistics_) throw BagError("the bag holds no positions from a step -1 on");
  const Arrivals& arrivals = statistics_->arrivals();
  const bool complete = arrivals.complete();
  const bool has_an_end = platoon_.configuration.run.averaging() == Averaging::over_realizations;
  if (!complete && has_an_end) find_missing(arrivals);
  for (const std::string& changed : changed_figures()) find(kErrorStatisticsTopic, changed);
  return {platoon_.configuration, statistics_->result(complete), findings_, {}};
}

void RunReading::find_missing(const Arrivals& arrivals) {
  const std::vector<std::optional<MessageId>> all = arrivals.latest();
  const bool alike = std::all_of(all.begin(), all.end(), [&all](const std::optional<MessageId>& id) {
    return id && all.front() && id->first_realization == all.front()->first_realization &&
           id->step == all.front()->step;
  });
  if (alike) return findings_.push_back("all positions end with " + named(*all.front()));
  for (std::size_t i = 0; i <= platoon_.configuration.run.followers; ++i) {
    const std::optional<MessageId> latest = arrivals.latest(i);
    find(position_topic(i),
         latest ? "ends with " + named(*latest) : std::string("holds nothing of the latest attempt"));
  }
}

std::vector<std::string> RunReading::changed_figures() const {
  const RunOptions& run = platoon_.configuration.run;
  std::vector<std::string> changed;
  if (!statistics_ || !statistics_->arrivals().complete() || run.averaging() == Averaging::over_time) return changed;
  const RunResult result = statistics_->result(true);
  if (result.realizations != run.realizations) return changed;  // resumed: the figures include earlier realizations
  for (const auto& [step, figures] : figures_) {
    bool same = step >= 0 && step < run.steps && figures->mean.size() == run.followers &&
                figures->variance.size() == run.followers;
    for (std::size_t i = 1; same && i <= run.followers; ++i) {
      const Moments& measured = result.moments[cell(i, step, run.steps)];
      same = is_same(measured.mean, figures->mean[i - 1]) && is_same(measured.variance(), figures->variance[i - 1]);
    }
    if (!same)
      changed.push_back("the figures of step " + std::to_string(step) +
                        " are not those of the positions beside them: the recording is damaged");
  }
  return changed;
}

void RunReading::find(const std::string& topic, const std::string& what) {
  if (counts_[topic]++ < kFindingsPerTopic) findings_.push_back(topic + ": " + what);
  if (counts_[topic] == kFindingsPerTopic + 1) findings_.push_back(topic + ": and more");
}

}  // namespace platoon
