#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "stochastic_platoon/ros/bags/bag_source.hpp"
#include "stochastic_platoon/ros/bags/run_reading.hpp"

namespace platoon {

/// Runs the positions of a recorded platoon through the same statistics as the monitor's. `progress` is called with the
/// bytes read and their number. Throws BagError as recorded_platoon() does, for more than one run, and for files that
/// are not as `source` accepts them.
BagStatistics statistics_of_bags(const BagSource& source,
                                 const std::function<void(std::uint64_t, std::uint64_t)>& progress);

/// What the bags were recorded with: their first configuration. Throws BagError when there is none, or one of another
/// version of this package.
RecordedPlatoon recorded_platoon(const BagSource& source);

/// y_0(-1) .. y_0(steps - 1) [m] as recorded: the leader's positions in the first batch of the bags. Throws
/// BagError when there are fewer.
std::vector<double> recorded_leader(const BagSource& source, std::int64_t steps);

}  // namespace platoon
