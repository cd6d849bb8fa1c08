#pragma once

#include <stochastic_platoon/ErrorStatistics.h>
#include <stochastic_platoon/Position.h>

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "stochastic_platoon/ros/messages/topics.hpp"
#include "stochastic_platoon/run/results/run_statistics.hpp"

namespace platoon {

/// A recorded run.
struct RecordedPlatoon {
  Configuration configuration;
  std::string name_space;  ///< of its platoon, "/platoon"
};

/// What a bag's positions amount to.
struct BagStatistics {
  Configuration configuration;  ///< of the run that was recorded
  RunResult result;             ///< of the whole batches in the bag
  /// What is missing, duplicated or foreign: by topic and step, at most some of each.
  std::vector<std::string> findings;
  std::set<std::string> foreign_topics;  ///< of other names or types: passed over
};

/// A recorded run's positions on their way through the same statistics as the monitor's, held to what was recorded
/// beside them: order, completeness, the run, and the figures that the monitor published in the end. These are
/// a pure function of the positions, so that they differ when a bit of what was read is not as it was recorded.
class RunReading {
public:
  explicit RunReading(const RecordedPlatoon& platoon);

  /// In the order of the recorded times.
  void take(const PlatoonTopic& topic, const stochastic_platoon::Position::ConstPtr& message);
  void take(const PlatoonTopic& topic, const stochastic_platoon::ErrorStatistics::ConstPtr& message);

  /// Of what was taken, with what is wrong with it. Throws BagError when no positions from a step -1 on were.
  BagStatistics statistics();

  /// Steps whose recorded figures are not those of what was taken, in words; none before that is a whole run.
  std::vector<std::string> changed_figures() const;

private:
  void find_missing(const Arrivals& arrivals);
  void find(const std::string& topic, const std::string& what);

  RecordedPlatoon platoon_;
  std::uint64_t run_;
  std::unique_ptr<RunStatistics> statistics_;
  std::map<std::int64_t, stochastic_platoon::ErrorStatistics::ConstPtr> figures_;  ///< of all realizations, by step
  std::map<std::string, std::size_t> counts_;
  std::vector<std::string> findings_;
};

}  // namespace platoon
