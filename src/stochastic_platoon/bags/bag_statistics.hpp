#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "stochastic_platoon/bags/run_reading.hpp"

namespace platoon {

/// Runs the positions of a recorded platoon through the same statistics as the monitor's.
///
/// `partial` allows a single file that is damaged or was not closed, and reads what there is of it.
/// `progress` is called with the messages read and their number. Throws BagError as recorded_platoon() does,
/// and for a bag that cannot be read so.
BagStatistics statistics_of_bags(const std::vector<std::string>& files, bool partial,
                                 const std::function<void(std::uint64_t, std::uint64_t)>& progress);

/// What the bags were recorded with. Throws BagError when they hold none or more than one run, or one of
/// another version of this package.
RecordedPlatoon recorded_platoon(const std::vector<std::string>& files);

/// y_0(-1) .. y_0(steps - 1) [m] as recorded: the leader's positions in the first batch of the bags. Throws
/// BagError when there are fewer.
std::vector<double> recorded_leader(const std::vector<std::string>& files, std::int64_t steps);

}  // namespace platoon
