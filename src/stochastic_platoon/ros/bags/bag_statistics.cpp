#include "stochastic_platoon/ros/bags/bag_statistics.hpp"

#include <algorithm>
#include <utility>

#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/ros/bags/bag_stream.hpp"
#include "stochastic_platoon/ros/messages/position.hpp"
#include "stochastic_platoon/run/configuration/configuration_document.hpp"

namespace platoon {

using stochastic_platoon::Position;

namespace {

// Throws BagError if its version is not readable or it is damaged.
Configuration parse_recorded(const std::string& file, const std::string& text) {
  try {
    return parse_recorded_configuration(text);
  } catch (const ConfigurationError& error) {
    throw BagError(file + ": its configuration is not valid: " + error.what());
  }
}

}  // namespace

Configuration configuration_to_repeat(const BagSource& source) {
  Configuration configuration = recorded_platoon(source).configuration;
  configuration.run.record.clear();
  configuration.run.resume = false;
  configuration.run.rate = 0.0;
  configuration.run.first_realization = 0;
  return configuration;
}

// Checks neither the version nor the model, which may be of any run.
std::optional<std::string> launch_of(const std::string& file) try {
  BagStream stream({{file}, Accept::damaged, true}, is_configuration);
  const std::optional<RecordedMessage> message = stream.next();
  if (!message) return std::nullopt;
  const auto document = nlohmann::json::parse(std::get<std::string>(message->content));
  return document.at(nlohmann::json::json_pointer("/run/launch_id")).get<std::string>();
} catch (const BagError&) {
  return std::nullopt;
} catch (const nlohmann::json::exception&) {
  return std::nullopt;
}

std::vector<double> recorded_leader(const BagSource& source, std::int64_t steps) {
  BagStream stream(source, [](const PlatoonTopic& topic) {
    return topic.kind == PlatoonTopic::Kind::position && topic.vehicle == 0;
  });
  const std::string& file = source.files.front();
  const std::uint64_t run = run_identity(recorded_platoon(source).configuration);
  const auto count = static_cast<std::size_t>(steps + 1);
  std::vector<double> positions;
  // To the end: another run there, or damage, is an error.
  while (const std::optional<RecordedMessage> recorded = stream.next()) {
    if (positions.size() == count) continue;
    const Position::ConstPtr message = recorded->position();
    if (message->run != run) continue;
    if (message->step == kInitialStep) positions.clear();
    const std::vector<double>& all = message->position;
    if (std::any_of(all.begin(), all.end(), [&all](double position) { return position != all.front(); })) {
      throw BagError(file + ": is damaged: the leader is not at one place at step " + std::to_string(message->step));
    }
    const bool due = message->step + 1 == static_cast<std::int64_t>(positions.size());
    if (due && !all.empty()) positions.push_back(all.front());
  }
  if (positions.size() == count) return positions;
  throw BagError(file + ": holds " + std::to_string(positions.size()) + " steps of a leader: must hold steps -1 to " +
                 std::to_string(steps - 1));
}

Configuration repeated(const BagSource& source, const std::map<std::string, std::string>& settings,
                       bool behind_recorded_leader) {
  Configuration base = configuration_to_repeat(source);
  if (!behind_recorded_leader) return parse_configuration(configuration_document(base, settings));
  const std::vector<std::string> signals = std::exchange(base.run.signals, {});
  Configuration configuration = parse_configuration(configuration_document(base, settings));
  if (configuration.model.sample_period != base.model.sample_period) {
    throw ConfigurationError(
        {formatted("model/sample_period: %.10g: must be %.10g [s], that of the recording, as the recorded leader has a "
                   "position for each of its steps",
                   configuration.model.sample_period, base.model.sample_period)});
  }
  configuration.model.recorded_leader = recorded_leader(source, configuration.run.steps);
  if (configuration.run.signals.empty()) configuration.run.signals = signals;
  // The control input of another model may not be known, and a replay cannot choose its signals.
  std::vector<std::string>& chosen = configuration.run.signals;
  if (settings.count("signals") == 0 && !signal_problems(configuration).empty())
    chosen.erase(std::remove(chosen.begin(), chosen.end(), kInput), chosen.end());
  return parse_configuration(to_json(configuration).dump());
}

RecordedPlatoon recorded_platoon(const BagSource& source) {
  const std::string& file = source.files.front();
  BagStream stream(source, is_configuration);
  const std::optional<RecordedMessage> message = stream.next();
  if (!message) throw BagError(file + ": holds no topic \"configuration\": it is no recording of a platoon");
  return {parse_recorded(file, std::get<std::string>(message->content)), message->topic.name_space};
}

BagStatistics statistics_of_bags(const BagSource& source,
                                 const std::function<void(std::uint64_t, std::uint64_t)>& progress,
                                 const std::optional<std::vector<std::string>>& signals) {
  using Kind = PlatoonTopic::Kind;
  RunReading reading(recorded_platoon(source), signals);
  BagStream stream(source, [](const PlatoonTopic& topic) {
    return topic.kind == Kind::position || topic.kind == Kind::input || topic.kind == Kind::error_statistics;
  });
  for (std::uint64_t count = 0; const std::optional<RecordedMessage> message = stream.next(); ++count) {
    reading.take(*message);
    if (progress && count % 256 == 0) progress(stream.position(), stream.size());
  }
  if (progress) progress(stream.size(), stream.size());
  BagStatistics statistics = reading.statistics();
  statistics.foreign_topics = stream.foreign_topics();
  if (!stream.ending().empty()) statistics.findings.insert(statistics.findings.begin(), "the file " + stream.ending());
  return statistics;
}

}  // namespace platoon
