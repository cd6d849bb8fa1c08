#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "stochastic_platoon/math/statistics/ensemble_totals.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"
#include "stochastic_platoon/run/io/folder_lock.hpp"
#include "stochastic_platoon/run/results/run_result.hpp"

namespace platoon {

/// Committed totals of a run, sufficient to continue it.
struct Checkpoint {
  nlohmann::json identity;  ///< statistics_identity() of the run
  std::string launch_id;    ///< the launch that wrote it
  Tally tally;
  EnsembleTotals totals;                    ///< without cells for averages over time
  std::vector<Moments> time_averages = {};  ///< averages over time, one per follower; else empty
  std::string damage = {};                  ///< after reading: why this is not the latest checkpoint; empty: it is
  nlohmann::json shard = {};                ///< identifies the shard (see ShardRun); null for a whole run
};

/// "1000 realizations", or the number of steps of an average over time.
std::string extent_of(const Checkpoint& checkpoint);

/// File names of the checkpoint in the output folder, and of the previous checkpoint.
std::string checkpoint_file(const std::string& output);
std::string previous_checkpoint_file(const std::string& output);

/// Removes both.
void remove_checkpoints(const std::string& output);

/// Writes a line with the format, a line with the digest of the rest, and CBOR (RFC 8949), in which doubles keep their
/// bits. The write is atomic and keeps the previous checkpoint. Throws std::runtime_error.
void write_checkpoint(const std::string& output, const Checkpoint& checkpoint);

/// A file that is not a checkpoint, or has changed since it was written.
class DamagedCheckpoint : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

/// The folder's checkpoint; none if there is no file. A damaged checkpoint, whose digest does not match its content, is
/// never used: the previous one takes its place, and `damage` gives the reason. Throws std::runtime_error if neither
/// can be read, DamagedCheckpoint if both are damaged.
std::optional<Checkpoint> read_checkpoint(const std::string& output);

/// The checkpoint from which this run starts: none in a fresh folder; the folder's own if it comes from the same launch
/// (a restarted node) or `resume` is set. Throws ConfigurationError if the folder cannot be written; if it holds
/// results and neither is the case (nothing is overwritten); or if its checkpoint has another configuration, whose
/// differences are listed, or does not hold realizations 0, 1, ... without a gap.
std::optional<Checkpoint> starting_point(const Configuration& configuration);

/// Throws ConfigurationError if the folder holds results, of a run or an estimation, which are never overwritten, other
/// than a statistics.csv that a killed write_results() left without its summary.
void require_no_results(const std::string& output);

/// Throws ConfigurationError for the faults of an output folder that can be known without creating it and without the
/// run, so that they can be named beside others. `for_results`: also for results in it and no checkpoint.
void require_possible_output(const std::string& output, bool for_results = true);

/// Environment variable of a node that its launch ends and restarts.
constexpr char kEndsWithLaunch[] = "PLATOON_ENDS_WITH_LAUNCH";

/// Creates the run's output folder if necessary and locks it for this launch. Throws ConfigurationError if it cannot be
/// written, or if another holder has it; the message names the holder and how long to wait.
std::unique_ptr<FolderLock> lock_output(const RunOptions& run);

}  // namespace platoon
