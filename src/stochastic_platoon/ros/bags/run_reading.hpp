#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "stochastic_platoon/ros/bags/recorded_messages.hpp"
#include "stochastic_platoon/run/results/run_statistics.hpp"

namespace platoon {

/// A recorded run.
struct RecordedPlatoon {
  Configuration configuration;
  std::string name_space;  ///< of its platoon, "/platoon"
};

/// Statistics and findings from a bag's positions.
struct BagStatistics {
  Configuration configuration;  ///< of the run that was recorded
  RunResult result;             ///< of the whole batches in the bag
  /// Missing, duplicated and foreign messages by topic and step, at most three per topic.
  std::vector<std::string> findings;
  std::set<std::string> foreign_topics;  ///< of other names or types, skipped
};

/// Passes the positions of a recorded run through the monitor's statistics and checks order, completeness, run identity
/// and the statistics that the monitor published at the end. These are a pure function of the positions: they differ if
/// a bit of the positions has changed.
class RunReading {
public:
  /// `signals`: computed instead of those of the recorded run (see signal_kinds()).
  explicit RunReading(const RecordedPlatoon& platoon,
                      const std::optional<std::vector<std::string>>& signals = std::nullopt);

  /// Takes positions and inputs of vehicles and error statistics in the order of the recorded times.
  void take(const RecordedMessage& message);

  /// Statistics and findings of the messages taken. Throws BagError if there are no positions from a step -1 on.
  BagStatistics statistics();

  /// Descriptions of the steps at which the recorded statistics differ from those of the positions; empty until the run
  /// is complete.
  std::vector<std::string> changed_figures() const;

private:
  void take_values(const PlatoonTopic& topic, const stochastic_platoon::Position::ConstPtr& message);
  void find_missing(const Arrivals& arrivals);
  void find(const std::string& topic, const std::string& what);

  RecordedPlatoon platoon_;
  std::uint64_t run_;
  std::vector<std::size_t> measured_;  ///< followers whose inputs are read
  std::unique_ptr<RunStatistics> statistics_;
  std::map<std::int64_t, stochastic_platoon::ErrorStatistics::ConstPtr> figures_;  ///< of all realizations, by step
  std::map<std::string, std::size_t> counts_;
  std::vector<std::string> findings_;
};

}  // namespace platoon
