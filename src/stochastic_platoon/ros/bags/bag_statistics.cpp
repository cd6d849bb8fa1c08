#include "stochastic_platoon/ros/bags/bag_statistics.hpp"

#include <algorithm>

#include "stochastic_platoon/ros/bags/bag_reader.hpp"
#include "stochastic_platoon/ros/bags/bag_stream.hpp"
#include "stochastic_platoon/ros/messages/position.hpp"
#include "stochastic_platoon/run/configuration/version.hpp"

namespace platoon {

using stochastic_platoon::ErrorStatistics;
using stochastic_platoon::Position;

namespace {

// Throws BagError if it was recorded by another version or is damaged.
Configuration parse_recorded(const std::string& file, const std::string& text) {
  try {
    const YAML::Node document = YAML::Load(text);
    const std::string version =
        document.IsMap() && document["version"] ? document["version"].as<std::string>() : "0.1.0";
    if (version != kVersion) {
      throw BagError(file + ": was recorded by stochastic_platoon " + version + ": must be of " + kVersion +
                     ", this program's");
    }
    return parse_configuration(document);
  } catch (const YAML::Exception& error) {
    throw BagError(file + ": its configuration cannot be read: " + error.what());
  } catch (const ConfigurationError& error) {
    throw BagError(file + ": its configuration is not valid: " + error.what());
  }
}

// Finds the only run in the bags and its configuration.
class RunFinder {
public:
  explicit RunFinder(std::string file) : file_(std::move(file)) {}

  void take(const PlatoonTopic& topic, const std::string& text) {
    if (found_ && text == text_ && topic.name_space == found_->name_space) return;  // a repeated latched message
    if (found_) throw BagError(file_ + ": holds more than one run of a platoon: must hold one");
    found_ = RecordedPlatoon{parse_recorded(file_, text), topic.name_space};
    text_ = text;
  }

  const std::optional<RecordedPlatoon>& found() const { return found_; }

  const RecordedPlatoon& require() const {
    if (found_) return *found_;
    throw BagError(file_ + ": holds no topic \"configuration\": it is no recording of a platoon");
  }

private:
  std::string file_;
  std::string text_;
  std::optional<RecordedPlatoon> found_;
};

}  // namespace

std::vector<double> recorded_leader(const BagSource& source, std::int64_t steps) {
  BagStream stream(source, [](const PlatoonTopic& topic) {
    return topic.kind == PlatoonTopic::Kind::position && topic.vehicle == 0;
  });
  const std::string& file = source.files.front();
  std::vector<double> positions;
  while (positions.size() < static_cast<std::size_t>(steps + 1)) {
    const std::optional<RecordedMessage> recorded = stream.next();
    if (!recorded) break;
    const Position::ConstPtr message = std::get<Position::Ptr>(recorded->content);
    if (message->step == kInitialStep) positions.clear();
    const std::vector<double>& all = message->position;
    if (std::any_of(all.begin(), all.end(), [&all](double position) { return position != all.front(); })) {
      throw BagError(file + ": is damaged: the leader is not at one place at step " + std::to_string(message->step));
    }
    const bool due = message->step + 1 == static_cast<std::int64_t>(positions.size());
    if (due && !all.empty()) positions.push_back(all.front());
  }
  if (positions.size() == static_cast<std::size_t>(steps + 1)) return positions;
  throw BagError(file + ": holds " + std::to_string(positions.size()) + " steps of a leader: must hold steps -1 to " +
                 std::to_string(steps - 1));
}

RecordedPlatoon recorded_platoon(const BagSource& source) {
  RunFinder finder(source.files.front());
  BagStream stream(source, [](const PlatoonTopic& topic) { return topic.kind == PlatoonTopic::Kind::configuration; });
  if (const std::optional<RecordedMessage> message = stream.next())
    finder.take(message->topic, std::get<std::string>(message->content));
  return finder.require();
}

BagStatistics statistics_of_bags(const BagSource& source,
                                 const std::function<void(std::uint64_t, std::uint64_t)>& progress,
                                 const std::optional<std::vector<std::string>>& signals) {
  RunFinder finder(source.files.front());
  RunReading reading(recorded_platoon(source), signals);
  BagContent content;
  content.configuration = [&finder](const PlatoonTopic& topic, const std::string& text) { finder.take(topic, text); };
  content.position = [&reading](const PlatoonTopic& topic, const Position::ConstPtr& message) {
    reading.take(topic, message);
  };
  content.error_statistics = [&reading](const PlatoonTopic& topic, const ErrorStatistics::ConstPtr& message) {
    reading.take(topic, message);
  };
  content.progress = progress;
  const BagRemainder remainder = read_bags(source, content);
  BagStatistics statistics = reading.statistics();
  statistics.foreign_topics = remainder.foreign_topics;
  if (!remainder.ending.empty())
    statistics.findings.insert(statistics.findings.begin(), "the file " + remainder.ending);
  return statistics;
}

}  // namespace platoon
