#include "stochastic_platoon/bags/bag_statistics.hpp"

#include <algorithm>

#include "stochastic_platoon/bags/bag_stream.hpp"

namespace platoon {

using stochastic_platoon::Position;

namespace {

constexpr std::size_t kFindingsPerTopic = 3;

BagRest read(const std::vector<std::string>& files, bool partial, const BagContent& content) {
  return partial && files.size() == 1 ? read_damaged_bag(files.front(), content) : read_bags(files, content);
}

std::string named(const Turn& turn) {
  return "step " + std::to_string(turn.step) + " of the realizations from " +
         std::to_string(turn.first_realization);
}

class Reading {
public:
  explicit Reading(const RecordedPlatoon& platoon) : platoon_(platoon) {}

  void take(const PlatoonTopic& topic, const Position::ConstPtr& message) {
    if (topic.name_space != platoon_.name_space) return;
    const std::string name = "vehicle_" + std::to_string(topic.vehicle) + "/position";
    if (topic.vehicle > platoon_.configuration.run.followers)
      return find(name, "is no vehicle of the recorded platoon");
    const Turn turn{message->attempt, message->first_realization, message->step};
    if (!statistics_) {
      if (turn.step != kInitialStep) return;  // of an attempt whose start was missed
      statistics_ = std::make_unique<RunStatistics>(platoon_.configuration, turn.first_realization);
    }
    statistics_->tally.platoon_time =
        std::max(statistics_->tally.platoon_time, message->header.stamp.toNSec());
    const std::optional<Turn> before = statistics_->arrivals().latest(topic.vehicle);
    const Verdict verdict = statistics_->receive(
        topic.vehicle, turn, Positions(&message->position, [message](const std::vector<double>*) {}));
    if (verdict != Verdict::in_turn && verdict != Verdict::stale)
      find(name, described(verdict, turn, before));
  }

  BagStatistics statistics() {
    if (!statistics_) throw BagError("the bag holds no positions from a step -1 on");
    const Arrivals& arrivals = statistics_->arrivals();
    const bool complete = arrivals.complete();
    if (!complete && !statistics_->endless()) find_missing(arrivals);
    return {platoon_.configuration, statistics_->result(complete), findings_, {}};
  }

private:
  static std::string described(Verdict verdict, const Turn& turn, const std::optional<Turn>& before) {
    if (verdict != Verdict::out_of_turn || !before) return named(turn) + " is " + to_string(verdict);
    const bool again = std::make_pair(turn.first_realization, turn.step) <=
                       std::make_pair(before->first_realization, before->step);
    return again ? named(turn) + " comes twice"
                 : named(turn) + " follows " + named(*before) + ": what is between is missing";
  }

  void find_missing(const Arrivals& arrivals) {
    const std::vector<std::optional<Turn>> all = arrivals.latest();
    const bool alike = std::all_of(all.begin(), all.end(), [&all](const std::optional<Turn>& turn) {
      return turn && all.front() && turn->first_realization == all.front()->first_realization &&
             turn->step == all.front()->step;
    });
    if (alike) return findings_.push_back("all positions end with " + named(*all.front()));
    for (std::size_t i = 0; i <= platoon_.configuration.run.followers; ++i) {
      const std::optional<Turn> latest = arrivals.latest(i);
      const std::string name = "vehicle_" + std::to_string(i) + "/position";
      find(name, latest ? "ends with " + named(*latest) : std::string("holds nothing of the latest attempt"));
    }
  }

  // What an attempt that was given up lacked is in the one that took its place.
  void forgive() {
    attempt_ = statistics_->arrivals().attempt();
    counts_.clear();
    findings_.clear();
  }

  void find(const std::string& topic, const std::string& what) {
    if (counts_[topic]++ < kFindingsPerTopic) findings_.push_back(topic + ": " + what);
    if (counts_[topic] == kFindingsPerTopic + 1) findings_.push_back(topic + ": and more");
  }

  RecordedPlatoon platoon_;
  std::unique_ptr<RunStatistics> statistics_;
  std::uint32_t attempt_ = 0;
  std::map<std::string, std::size_t> counts_;
  std::vector<std::string> findings_;
};

}  // namespace

std::vector<double> recorded_leader(const std::vector<std::string>& files, std::int64_t steps) {
  if (files.empty()) return {};
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

RecordedPlatoon recorded_platoon(const std::vector<std::string>& files, bool partial) {
  std::map<std::string, std::string> texts;
  BagContent content;
  content.configuration = [&texts](const PlatoonTopic& topic, const std::string& text) {
    texts.emplace(topic.name_space, text);
  };
  read(files, partial, content);
  if (texts.size() == 1)
    return {parse_configuration(YAML::Load(texts.begin()->second)), texts.begin()->first};
  if (texts.empty())
    throw BagError(files.front() + ": holds no topic \"configuration\": it is no recording of a platoon");
  throw BagError(files.front() + ": holds " + std::to_string(texts.size()) + " platoons: must hold one");
}

BagStatistics statistics_of_bags(const std::vector<std::string>& files, bool partial,
                                 const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
  Reading reading(recorded_platoon(files, partial));
  BagContent content;
  content.position = [&reading](const PlatoonTopic& topic, const Position::ConstPtr& message) {
    reading.take(topic, message);
  };
  content.progress = progress;
  const BagRest rest = read(files, partial, content);
  BagStatistics statistics = reading.statistics();
  statistics.foreign_topics = rest.foreign_topics;
  if (!rest.damage.empty())
    statistics.findings.insert(statistics.findings.begin(), "the file is damaged: " + rest.damage);
  return statistics;
}

}  // namespace platoon
