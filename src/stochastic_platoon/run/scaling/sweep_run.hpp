#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "stochastic_platoon/run/scaling/sweep_file.hpp"

namespace platoon {

/// How a sweep is computed.
struct SweepSettings {
  std::string output;
  unsigned threads = 1;
  std::function<void(std::uint64_t realizations, const std::string& point)> progress = [](std::uint64_t,
                                                                                          const std::string&) {};
  std::function<void(const std::string&)> warn = [](const std::string&) {};  ///< of what is not used
};

/// The points that the folder does not hold yet. Throws ConfigurationError when it holds points of another sweep.
std::vector<std::uint64_t> missing_points(const Sweep& sweep, const SweepSettings& settings);

/// Computes points, on all threads at a time, and writes the rows of each as soon as it is complete. `progress`
/// is told the realizations of these points done so far, and the name of the point at hand. Throws std::runtime_error
/// when rows cannot be written.
void compute_points(const Sweep& sweep, const std::vector<std::uint64_t>& points, const SweepSettings& settings);

/// Writes the rows of these points, of which every shard is in its folder. Throws ConfigurationError with what is
/// wrong, and the numbers of the tasks (point x shards + shard) to compute.
void merge_points(const Sweep& sweep, const std::vector<std::uint64_t>& points, const SweepSettings& settings);

}  // namespace platoon
