#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "stochastic_platoon/run/results/run_result.hpp"
#include "stochastic_platoon/run/scaling/sweep_file.hpp"

namespace platoon {

/// The heading of sweep.csv: point, the axes, vehicle, step, count, mean and variance with their standard errors,
/// theory, and the verdicts string_stable and agrees (whether the whole point agrees with the theory): 1, 0, or empty
/// without a verdict.
std::string sweep_heading(const Sweep& sweep);

/// The rows of a point in sweep.csv.
std::string sweep_rows(const Sweep& sweep, std::uint64_t point, const Configuration& configuration,
                       const Prediction& prediction, const RunResult& result);

/// The file that keeps a point's rows until all points are there, and the folder of its shard.
std::string point_file(const std::string& output, std::uint64_t point);
std::string shard_folder(const std::string& output, std::uint64_t point, std::uint64_t shard);

/// Content of a point's file: digests of its rows and of their inputs, then the rows.
std::string point_content(const Sweep& sweep, std::uint64_t point, const std::string& rows);

/// A point's rows as they were written; none without a file, or for a damaged one, which sets `damage`. Throws
/// ConfigurationError if the file belongs to another sweep, std::system_error if it cannot be read.
std::optional<std::string> read_point(const Sweep& sweep, const std::string& output, std::uint64_t point,
                                      std::string* damage);

/// Combines the rows of all points in output/sweep.csv, and writes sweep.json with the provenance of point 0 and the
/// checksums of both. Throws std::runtime_error, and std::invalid_argument for a damaged sweep.json.
void write_sweep(const Sweep& sweep, const std::string& output);

}  // namespace platoon
