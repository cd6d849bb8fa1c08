#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "stochastic_platoon/run/results/run_result.hpp"
#include "stochastic_platoon/run/scaling/sweep_file.hpp"

namespace platoon {

/// The heading of sweep.csv: point, what varies, vehicle, step, count, and of each row mean and variance with their
/// standard errors, theory, and the verdicts: string_stable, and agrees, whether the whole point agrees with
/// the theory (1, 0, or empty where there is none).
std::string sweep_heading(const Sweep& sweep);

/// The rows of a point, as they stand in sweep.csv.
std::string sweep_rows(const Sweep& sweep, std::uint64_t point, const Configuration& configuration,
                       const Prediction& prediction, const RunResult& result);

/// Where a point's rows are kept until all are there, and the folder of its shard.
std::string point_file(const std::string& output, std::uint64_t point);
std::string shard_folder(const std::string& output, std::uint64_t point, std::uint64_t shard);

/// What stands in a point's file: its rows behind digests of themselves and of what they are a function of.
std::string point_content(const Sweep& sweep, std::uint64_t point, const std::string& rows);

/// A point's rows as they were written; none where there is no file, or a damaged one, and then `damage` says so.
/// Throws ConfigurationError when it is of another sweep.
std::optional<std::string> read_point(const Sweep& sweep, const std::string& output, std::uint64_t point,
                                      std::string* damage);

/// Puts the rows of all points together in output/sweep.csv. Throws std::runtime_error.
void write_sweep(const Sweep& sweep, const std::string& output);

}  // namespace platoon
