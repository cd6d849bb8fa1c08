#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "stochastic_platoon/run/scaling/sweep_file.hpp"

namespace platoon {

/// Settings of a sweep's computation.
struct SweepSettings {
  std::string output;
  unsigned threads = 1;
  std::function<void(std::uint64_t realizations, const std::string& point)> progress = [](std::uint64_t,
                                                                                          const std::string&) {};
  std::function<void(const std::string&)> warn = [](const std::string&) {};  ///< gets slow noise and damaged files
};

/// The points that the folder does not hold yet. Throws ConfigurationError if it holds points of another sweep, and
/// std::invalid_argument if its sweep.json is another file.
std::vector<std::uint64_t> missing_points(const Sweep& sweep, const SweepSettings& settings);

/// Computes points on all threads, and writes the rows of each point as soon as it is complete. `progress` receives the
/// number of realizations of these points done so far, and the name of the present point. Throws std::runtime_error if
/// rows cannot be written.
void compute_points(const Sweep& sweep, const std::vector<std::uint64_t>& points, const SweepSettings& settings);

/// Writes the rows of these points from the folders of their shards, which must all be there. Throws ConfigurationError
/// with all problems and the numbers of the tasks (point x shards + shard) to compute.
void merge_points(const Sweep& sweep, const std::vector<std::uint64_t>& points, const SweepSettings& settings);

}  // namespace platoon
