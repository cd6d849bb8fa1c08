#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "stochastic_platoon/bags/bag_reader.hpp"
#include "stochastic_platoon/results/run_statistics.hpp"

namespace platoon {

/// What a bag's positions amount to.
struct BagStatistics {
  Configuration configuration;  ///< of the run that was recorded
  RunResult result;             ///< of the whole batches in the bag
  /// What is missing, duplicated or foreign: by topic and step, at most some of each.
  std::vector<std::string> findings;
  std::set<std::string> foreign_topics;  ///< of other names or types: passed over
};

/// Runs the positions of a recorded platoon through the same statistics as the monitor's.
///
/// `partial` allows a single file that is damaged or was not closed, and reads what there is of it.
/// `progress` is called with the messages read and their number. Throws BagError as recorded_platoon() does,
/// and for a bag that cannot be read so.
BagStatistics statistics_of_bags(const std::vector<std::string>& files, bool partial,
                                 const std::function<void(std::uint64_t, std::uint64_t)>& progress);

/// A recorded run.
struct RecordedPlatoon {
  Configuration configuration;
  std::string name_space;  ///< of its platoon, "/platoon"
};

/// What the bags were recorded with. Throws BagError when they hold none or more than one run, or one of
/// another version of this package.
RecordedPlatoon recorded_platoon(const std::vector<std::string>& files);

/// y_0(-1) .. y_0(steps - 1) [m] as recorded: the leader's positions in the first batch of the bags. Throws
/// BagError when there are fewer.
std::vector<double> recorded_leader(const std::vector<std::string>& files, std::int64_t steps);

}  // namespace platoon
