#include "stochastic_platoon/bags/bag_statistics.hpp"

#include <algorithm>

#include "stochastic_platoon/bags/bag_stream.hpp"
#include "stochastic_platoon/configuration/version.hpp"
#include "stochastic_platoon/messages/position.hpp"

namespace platoon {

using stochastic_platoon::Position;

namespace {

constexpr std::size_t kFindingsPerTopic = 3;

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

std::string named(const MessageId& id) {
  return "step " + std::to_string(id.step) + " of the realizations from " +
         std::to_string(id.first_realization);
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

class Reading {
public:
  explicit Reading(const RecordedPlatoon& platoon)
      : platoon_(platoon), run_(run_identity(platoon.configuration)) {}

  void take(const PlatoonTopic& topic, const Position::ConstPtr& message) {
    if (topic.name_space != platoon_.name_space) return;
    const std::string name = position_topic(topic.vehicle);
    if (topic.vehicle > platoon_.configuration.run.followers)
      return find(name, "is no vehicle of the recorded platoon");
    const Heading heading = heading_of(*message);
    if (message->run != run_) return find(name, described(Verdict::foreign_run, heading.id, std::nullopt));
    if (!statistics_) {
      if (heading.id.step != kInitialStep) return;  // of an attempt whose start was missed
      statistics_ = std::make_unique<RunStatistics>(platoon_.configuration, heading.id.first_realization);
    }
    statistics_->saw(message->header.stamp.toNSec());
    const std::optional<MessageId> before = statistics_->arrivals().latest(topic.vehicle);
    const Verdict verdict = statistics_->take(topic.vehicle, heading, positions_of(message));
    if (verdict != Verdict::in_turn && verdict != Verdict::stale)
      find(name, described(verdict, heading.id, before));
  }

  BagStatistics statistics() {
    if (!statistics_) throw BagError("the bag holds no positions from a step -1 on");
    const Arrivals& arrivals = statistics_->arrivals();
    const bool complete = arrivals.complete();
    const bool has_an_end = platoon_.configuration.run.averaging() == Averaging::over_realizations;
    if (!complete && has_an_end) find_missing(arrivals);
    return {platoon_.configuration, statistics_->result(complete), findings_, {}};
  }

private:
  static std::string described(Verdict verdict, const MessageId& id, const std::optional<MessageId>& before) {
    if (verdict != Verdict::out_of_turn || !before) return named(id) + " is " + to_string(verdict);
    const bool again = std::make_pair(id.first_realization, id.step) <=
                       std::make_pair(before->first_realization, before->step);
    return again ? named(id) + " comes twice"
                 : named(id) + " follows " + named(*before) + ": what is between is missing";
  }

  void find_missing(const Arrivals& arrivals) {
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

  void find(const std::string& topic, const std::string& what) {
    if (counts_[topic]++ < kFindingsPerTopic) findings_.push_back(topic + ": " + what);
    if (counts_[topic] == kFindingsPerTopic + 1) findings_.push_back(topic + ": and more");
  }

  RecordedPlatoon platoon_;
  std::uint64_t run_;
  std::unique_ptr<RunStatistics> statistics_;
  std::map<std::string, std::size_t> counts_;
  std::vector<std::string> findings_;
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
  Reading reading(recorded_platoon(files));
  BagContent content;
  content.position = [&reading](const PlatoonTopic& topic, const Position::ConstPtr& message) {
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
  std::optional<Reading> reading;
  BagContent content;
  content.configuration = [&](const PlatoonTopic& topic, const std::string& text) {
    finder.take(topic, text);
    if (!reading) reading.emplace(*finder.found());
  };
  content.position = [&](const PlatoonTopic& topic, const Position::ConstPtr& message) {
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
