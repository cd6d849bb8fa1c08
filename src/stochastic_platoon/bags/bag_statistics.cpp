#include "stochastic_platoon/bags/bag_statistics.hpp"

#include <algorithm>

#include "stochastic_platoon/bags/bag_reader.hpp"
#include "stochastic_platoon/bags/bag_stream.hpp"
#include "stochastic_platoon/configuration/version.hpp"
#include "stochastic_platoon/messages/position.hpp"

namespace platoon {

using stochastic_platoon::ErrorStatistics;
using stochastic_platoon::Position;

namespace {

// Throws BagError when it was recorded by another version, or is damaged.
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

// Finds the one run that the bags hold, and the configuration of it.
class RunFinder {
public:
  explicit RunFinder(std::string file) : file_(std::move(file)) {}

  void take(const PlatoonTopic& topic, const std::string& text) {
    if (found_ && text == text_ && topic.name_space == found_->name_space) return;  // latched, and sent again
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

std::vector<double> recorded_leader(const std::vector<std::string>& files, std::int64_t steps) {
  BagStream stream(files, [](const PlatoonTopic& topic) {
    return topic.kind == PlatoonTopic::Kind::position && topic.vehicle == 0;
  });
  std::vector<double> positions;
  while (positions.size() < static_cast<std::size_t>(steps + 1)) {
    const std::optional<RecordedPosition> recorded = stream.next();
    if (!recorded) break;
    if (recorded->message->step == kInitialStep) positions.clear();
    const std::vector<double>& all = recorded->message->position;
    if (std::any_of(all.begin(), all.end(), [&all](double position) { return position != all.front(); })) {
      throw BagError(files.front() + ": is damaged: the leader is not at one place at step " +
                     std::to_string(recorded->message->step));
    }
    const bool due = recorded->message->step + 1 == static_cast<std::int64_t>(positions.size());
    if (due && !recorded->message->position.empty()) positions.push_back(recorded->message->position.front());
  }
  if (positions.size() == static_cast<std::size_t>(steps + 1)) return positions;
  throw BagError(files.front() + ": holds " + std::to_string(positions.size()) +
                 " steps of a leader: must hold steps -1 to " + std::to_string(steps - 1));
}

RecordedPlatoon recorded_platoon(const std::vector<std::string>& files) {
  RunFinder finder(files.front());
  BagContent content;
  content.configuration = [&finder](const PlatoonTopic& topic, const std::string& text) {
    finder.take(topic, text);
  };
  read_bags(files, content);
  return finder.require();
}

namespace {

BagStatistics statistics_of_intact_bags(const std::vector<std::string>& files,
                                        const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
  RunReading reading(recorded_platoon(files));
  BagContent content;
  content.position = [&reading](const PlatoonTopic& topic, const Position::ConstPtr& message) {
    reading.take(topic, message);
  };
  content.error_statistics = [&reading](const PlatoonTopic& topic, const ErrorStatistics::ConstPtr& message) {
    reading.take(topic, message);
  };
  content.progress = progress;
  const BagRemainder remainder = read_bags(files, content);
  BagStatistics statistics = reading.statistics();
  statistics.foreign_topics = remainder.foreign_topics;
  return statistics;
}

// In one walk: a recording begins with its configuration.
BagStatistics statistics_of_damaged_bag(const std::string& file) {
  RunFinder finder(file);
  std::optional<RunReading> reading;
  BagContent content;
  content.configuration = [&](const PlatoonTopic& topic, const std::string& text) {
    finder.take(topic, text);
    if (!reading) reading.emplace(*finder.found());
  };
  content.position = [&](const PlatoonTopic& topic, const Position::ConstPtr& message) {
    if (reading) reading->take(topic, message);
  };
  content.error_statistics = [&](const PlatoonTopic& topic, const ErrorStatistics::ConstPtr& message) {
    if (reading) reading->take(topic, message);
  };
  const BagRemainder remainder = read_damaged_bag(file, content);
  finder.require();
  BagStatistics statistics = reading->statistics();
  statistics.foreign_topics = remainder.foreign_topics;
  if (!remainder.damage.empty())
    statistics.findings.insert(statistics.findings.begin(), "the file is damaged: " + remainder.damage);
  return statistics;
}

}  // namespace

BagStatistics statistics_of_bags(const std::vector<std::string>& files, bool partial,
                                 const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
  return partial && files.size() == 1 ? statistics_of_damaged_bag(files.front())
                                      : statistics_of_intact_bags(files, progress);
}

}  // namespace platoon
