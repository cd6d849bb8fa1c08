#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "stochastic_platoon/math/statistics/moment_table.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"
#include "stochastic_platoon/run/io/folder_lock.hpp"
#include "stochastic_platoon/run/results/run_result.hpp"

namespace platoon {

/// Committed totals of a run, enough to go on from.
struct Checkpoint {
  nlohmann::json identity;  ///< statistics_identity() of the run
  std::string launch_id;    ///< which launch wrote it
  Tally tally;
  MomentTable table;                        ///< of averages over time: of no cells
  std::vector<Moments> time_averages = {};  ///< of these, one per follower
  std::string damage = {};                  ///< of one that was read: why it is not the latest; empty: it is
  nlohmann::json shard = {};                ///< of a part of a run: of which (see ShardRun); null: of a whole one
};

/// "1000 realizations", or over how many steps it averages.
std::string extent_of(const Checkpoint& checkpoint);

/// Name of the checkpoint in the output folder, and of the one before it.
std::string checkpoint_file(const std::string& output);
std::string previous_checkpoint_file(const std::string& output);

/// A line that names the format, a line with the digest of what follows, and CBOR (RFC 8949), in which doubles
/// keep their bits. Written atomically; the checkpoint before it is kept. Throws std::runtime_error.
void write_checkpoint(const std::string& output, const Checkpoint& checkpoint);

/// A file that is no checkpoint, or not as it was written.
class DamagedCheckpoint : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

/// The folder's checkpoint; none when there is no file. A damaged one, whose digest is not its content's, is
/// never used: then it is the one before it, with a word in `damage`. Throws std::runtime_error when neither can
/// be read, DamagedCheckpoint when that is as both are damaged.
std::optional<Checkpoint> read_checkpoint(const std::string& output);

/// The checkpoint this run starts from: none in a fresh folder; the folder's own when it comes from the same
/// launch (a restarted node) or `resume` was asked for. Throws ConfigurationError when the folder cannot be
/// written, when it holds results and neither is the case (nothing is written over), and when its checkpoint
/// is of another configuration, which is named, or does not hold realizations 0, 1, ... without a gap.
std::optional<Checkpoint> starting_point(const Configuration& configuration);

/// What differs between two identities: "seed is 1 there and 2 here"; empty: nothing.
std::string identity_differences(const nlohmann::json& there, const nlohmann::json& here);

/// Throws ConfigurationError when the folder holds results, which are never written over.
void require_no_results(const std::string& output);

/// In the environment of a node that ends with its launch, and that this starts again.
constexpr char kEndsWithLaunch[] = "PLATOON_ENDS_WITH_LAUNCH";

/// Makes the run's output folder if need be, and takes it for this launch until the lock ends. Throws
/// ConfigurationError when it cannot be written, or is another's, which is named with how long to wait.
std::unique_ptr<FolderLock> lock_output(const RunOptions& run);

}  // namespace platoon
