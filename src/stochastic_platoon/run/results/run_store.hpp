#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "stochastic_platoon/run/io/folder_lock.hpp"
#include "stochastic_platoon/run/io/retried_write.hpp"
#include "stochastic_platoon/run/results/checkpoint.hpp"
#include "stochastic_platoon/run/results/run_result.hpp"

namespace platoon {

/// The locked output folder of one run, with its results and its checkpoints, about one per second. A failed write is
/// retried after a pause. Uses no clock: times are arguments [s].
class RunStore {
public:
  /// Throws ConfigurationError if another launch holds the folder.
  RunStore(const Configuration& configuration, RetriedWrite::Log failed, RetriedWrite::Log recovered);

  /// The checkpoint to continue from, see starting_point(). `damaged` gets a warning if the latest one is damaged.
  std::optional<Checkpoint> start(const RetriedWrite::Log& damaged);

  /// Whether a checkpoint with this number of positions is due.
  bool is_due(std::uint64_t positions, double now) const;
  void save(const Checkpoint& checkpoint, double now);

  /// False during the pause after a failure.
  bool can_write(double now) const;

  /// Saves the results of the complete run; returns false if that fails.
  bool complete(const Checkpoint& checkpoint, const Prediction& prediction, const RunResult& result, double now);

  /// Saves the results so far of a stopped run. Returns the reason if that fails, otherwise an empty string.
  [[nodiscard]] std::string stop(const Checkpoint& checkpoint, const Prediction& prediction, const RunResult& result);

private:
  Configuration configuration_;
  std::unique_ptr<FolderLock> lock_;
  RetriedWrite write_;
  std::uint64_t saved_ = 0;            ///< positions in the latest checkpoint
  std::optional<double> latest_ = {};  ///< [s] of the latest checkpoint of this launch
};

}  // namespace platoon
