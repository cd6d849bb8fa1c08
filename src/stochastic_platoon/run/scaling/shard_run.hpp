#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "stochastic_platoon/math/statistics/shard.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"
#include "stochastic_platoon/run/results/checkpoint.hpp"

namespace platoon {

/// A shard of a run: its folder is configuration.run.output, and the run is of configuration.run.realizations.
///
/// What it leaves is a checkpoint, of the range's realizations: as long as some are missing, what to go on from;
/// then what merge() joins. A checkpoint's digest tells every change of a byte.
struct ShardRun {
  Configuration configuration;
  Shard shard;

  RealizationRange range() const { return range_of(shard, configuration.run.realizations); }
};

/// Reads I/N. Throws ConfigurationError.
Shard parse_shard(const std::string& text, std::uint64_t realizations);

/// "shard 3/64".
std::string name_of(const Shard& shard);

/// What a checkpoint says of the shard that it is of: I, N and the configuration.
nlohmann::json to_json(const ShardRun& run);

/// From a checkpoint's word. Throws std::runtime_error when it is none, ConfigurationError when it is another
/// version's.
ShardRun shard_run_of(const nlohmann::json& record);

/// How a shard is computed.
struct ShardSettings {
  unsigned threads = 1;
  double checkpoint_seconds = 10.0;  ///< between checkpoints; a kill costs at most twice as much
  std::function<void(std::uint64_t done)> progress = [](std::uint64_t) {};
  /// Told what does not end it: a damaged checkpoint, a checkpoint that cannot be written just now.
  std::function<void(const std::string&)> warn = [](const std::string&) {};
};

/// Computes what its folder does not hold of the shard yet, and returns how many realizations that were: of a
/// complete shard 0. Throws ConfigurationError when the folder is another's, holds anything else, or cannot be
/// written, and std::runtime_error when the complete shard cannot be.
std::uint64_t compute_shard(const ShardRun& run, const ShardSettings& settings);

}  // namespace platoon
