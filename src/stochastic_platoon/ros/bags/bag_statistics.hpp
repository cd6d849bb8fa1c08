#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/ros/bags/bag_source.hpp"
#include "stochastic_platoon/ros/bags/run_reading.hpp"

namespace platoon {

/// The statistics of a recorded platoon's positions, computed as in the monitor. `progress` is called with the bytes
/// read and the total number of bytes. `signals`: see RunReading. Throws BagError as recorded_platoon() and BagStream
/// do.
BagStatistics statistics_of_bags(const BagSource& source,
                                 const std::function<void(std::uint64_t, std::uint64_t)>& progress,
                                 const std::optional<std::vector<std::string>>& signals = std::nullopt);

/// The first configuration in the bags, with its namespace. Throws BagError as BagStream does, if there is none, or if
/// its version is not readable.
RecordedPlatoon recorded_platoon(const BagSource& source);

/// The configuration in the bags for another run: without its record, resume, rate and first_realization. Throws
/// BagError as recorded_platoon() does.
Configuration configuration_to_repeat(const BagSource& source);

/// The launch_id in a file's first configuration; none if the file is no recording of a platoon.
std::optional<std::string> launch_of(const std::string& file);

/// y_0(-1) .. y_0(steps - 1) [m] as recorded: the leader's positions in the first batch of the bags, which are read to
/// their end. Throws BagError if there are fewer, and as BagStream does.
std::vector<double> recorded_leader(const BagSource& source, std::int64_t steps);

/// configuration_to_repeat() with these settings, see configuration_document(), for a run with the recorded leader or
/// with that of the model. Behind a recorded leader another model must have the recorded sample period, and the signal
/// `input` is left out if the model does not determine it. Throws ConfigurationError if they do not fit together.
Configuration repeated(const BagSource& source, const std::map<std::string, std::string>& settings,
                       bool behind_recorded_leader = false);

}  // namespace platoon
