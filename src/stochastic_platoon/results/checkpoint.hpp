#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "stochastic_platoon/configuration/configuration.hpp"
#include "stochastic_platoon/results/run_result.hpp"
#include "stochastic_platoon/statistics/moment_table.hpp"

namespace platoon {

/// Committed totals of a run, enough to go on from.
struct Checkpoint {
  nlohmann::json identity;  ///< statistics_identity() of the run
  std::string launch_id;    ///< which launch wrote it
  Tally tally;
  MomentTable table;
};

/// Name of the checkpoint in the output folder.
std::string checkpoint_file(const std::string& output);

/// CBOR (RFC 8949), written atomically; doubles keep their bits. Throws std::runtime_error.
void write_checkpoint(const std::string& output, const Checkpoint& checkpoint);

/// The folder's checkpoint; none when there is no file. Throws std::runtime_error when it cannot be read as
/// one.
std::optional<Checkpoint> read_checkpoint(const std::string& output);

/// The checkpoint this run starts from: none in a fresh folder; the folder's own when it comes from the same
/// launch (a restarted node) or `resume` was asked for. Throws ConfigurationError when the folder cannot be
/// written, when it holds results and neither is the case (nothing is written over), and when its checkpoint
/// is of another configuration: what differs is named.
std::optional<Checkpoint> starting_point(const Configuration& configuration);

}  // namespace platoon
