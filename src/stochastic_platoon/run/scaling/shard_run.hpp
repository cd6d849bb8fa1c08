#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "stochastic_platoon/math/simulation/ensemble_run.hpp"
#include "stochastic_platoon/math/statistics/shard.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"
#include "stochastic_platoon/run/results/checkpoint.hpp"

namespace platoon {

/// A shard of a run; shard 0/1 is the whole run. Its folder is configuration.run.output; configuration.run.realizations
/// is that of the whole run.
///
/// The folder holds a checkpoint of the range's realizations. An incomplete shard continues from it; merge() reads that
/// of a complete one. The checkpoint's digest detects any changed byte.
struct ShardRun {
  Configuration configuration;
  Shard shard;
  nlohmann::json rare = {};  ///< for samples of a RareRun instead of realizations: its identity and `samples`

  std::uint64_t samples() const;
  std::string unit() const;  ///< of samples: "realizations" or "repetitions"
  RealizationRange range() const { return range_of(shard, samples()); }
  nlohmann::json identity() const;  ///< of the statistics
};

/// Parses I/N, given the number of realizations or samples, if it is known. Throws ConfigurationError.
Shard parse_shard(const std::string& text, std::uint64_t realizations = kMostShards);

/// "shard 3/64".
std::string name_of(const Shard& shard);

/// The shard as its checkpoint describes it: I, N and the configuration.
nlohmann::json to_json(const ShardRun& run);

/// Reads that description. Throws std::runtime_error if it is invalid, ConfigurationError if another version wrote it.
ShardRun shard_run_of(const nlohmann::json& record);

/// Settings of a shard's computation.
struct ShardSettings {
  unsigned threads = 1;
  double checkpoint_seconds = 10.0;  ///< between checkpoints; a kill costs at most twice as much
  std::function<void(std::uint64_t done)> progress = [](std::uint64_t) {};
  /// Returns whether to stop: the shard is then incomplete, and its checkpoint holds every batch that was begun and
  /// that is complete within stop_seconds [s].
  std::function<bool()> stop = [] { return false; };
  double stop_seconds = std::numeric_limits<double>::infinity();
  /// Receives problems that do not end the shard: slow noise, a damaged checkpoint, or one that cannot be written at
  /// the moment.
  std::function<void(const std::string&)> warn = [](const std::string&) {};
};

/// Stops a run as its settings demand; to be called again and again.
class StopRequest {
public:
  explicit StopRequest(const ShardSettings& settings) : settings_(settings) {}
  void obey(EnsembleRun& run);

private:
  const ShardSettings& settings_;
  std::optional<double> since_;  ///< [s]
};

/// The parameters of a run's computation.
Ensemble ensemble_of(const RunOptions& run);

/// The realizations of a shard that its folder now holds, and how many of them were computed now.
struct ShardResult {
  Checkpoint checkpoint;
  std::uint64_t computed;
  std::string unsaved = {};  ///< the reason why the folder does not hold them; empty if it does
};

/// Computes the realizations of the shard that its folder, which the caller has locked, does not hold yet. Throws
/// ConfigurationError if the folder belongs to another run or shard, has other content, or cannot be written. If the
/// shard cannot be written at the end, it is returned with the reason.
ShardResult compute_shard(const ShardRun& run, const ShardSettings& settings);
/// The same with another computation than that of a Monte Carlo run.
ShardResult compute_shard(const ShardRun& run, const ShardSettings& settings, const BatchWork& computation);

}  // namespace platoon
