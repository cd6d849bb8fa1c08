#pragma once

#include <memory>
#include <string>

#include "stochastic_platoon/math/noise/white_noise.hpp"
#include "stochastic_platoon/math/numerics/interruption.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"
#include "stochastic_platoon/run/io/progress_display.hpp"
#include "stochastic_platoon/run/scaling/shard_run.hpp"
#include "tools/command_line.hpp"

namespace platoon {

constexpr int kInterrupted = 130;  ///< exit status, as the shell's after Ctrl-C

/// Ctrl-C or a scheduler's SIGTERM stops the run; the same signal again ends the program at once.
void stop_on_signals();

/// Whether such a signal has arrived.
bool stop_requested();

/// While it lives, such a signal ends the theory and the trajectories that this thread computes: they throw
/// Interrupted.
Interruptible interruptible_by_signals();

/// Writes trajectories.csv of a realization, as trajectories_csv(), and trajectories.json with its provenance and the
/// checksums of both. Returns the file. Throws ConfigurationError if the table exists.
std::string write_trajectories(const Configuration& configuration, std::uint64_t realization,
                               const std::shared_ptr<const ChangedDraws>& changes = nullptr);

/// The options `threads` and `checkpoint_seconds`, warnings on standard error, and the stop by signals. Throws
/// ConfigurationError.
ShardSettings shard_settings(const CommandLine& given);

/// The help of the options that these tools share.
extern const char *const kThreadsHelp, *const kShardHelp, *const kCheckpointHelp;

/// The display of a shard's progress; 0/1 is the whole run. A sample of a RareRun is no fixed number of vehicle-steps.
ProgressDisplay display_of(const ShardRun& run);

/// Prints that a shard is incomplete. Returns whether all its samples are done.
bool reported(const std::string& name, std::uint64_t done, const ShardRun& run);

/// Computes a shard with a display of its progress. Returns whether it is complete.
bool run_shard(ShardRun run, ShardSettings settings, const BatchWork& computation);

}  // namespace platoon
