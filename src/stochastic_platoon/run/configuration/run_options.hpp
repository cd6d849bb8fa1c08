#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "stochastic_platoon/run/configuration/section.hpp"
#include "stochastic_platoon/run/delivery/batch_schedule.hpp"

namespace platoon {

/// The largest number of followers.
inline constexpr std::int64_t kMaxFollowers = 1000000;

/// Limit of the noise counter for realizations and steps.
inline constexpr std::int64_t kMaxCount = std::int64_t{1} << 46;

/// The place where the vehicles of a run are computed. Launch files accept the first two.
enum class Hosting { processes, one_process, monte_carlo, bag };

/// Domain of the mean and the variance of a tracking error.
enum class Averaging { over_realizations, over_time };

/// "processes", ...
const char* to_string(Hosting hosting);

/// One run of a platoon: the launch arguments in C++.
struct RunOptions {
  std::size_t followers;       ///< N >= 1
  std::int64_t steps;          ///< K >= 1, or 0 for one endless batch
  std::uint64_t realizations;  ///< R >= 1; 1 in an endless run
  std::uint64_t batch;         ///< realizations per message, >= 1
  double rate;                 ///< steps per second of wall time; 0 = as fast as credit allows
  std::uint64_t seed;
  Hosting hosting;
  std::string output;               ///< folder for the results
  bool resume;                      ///< continue from the checkpoint in the folder
  std::uint64_t first_realization;  ///< earlier launches have committed all realizations before it
  std::string record;               ///< bag to record to; empty: none
  std::int64_t record_split_mb;     ///< begin a new bag beyond this size [MiB]; 0: one bag
  std::string record_compression;   ///< "none" or "lz4"
  std::string launch_id;            ///< names one launch, which always continues from its own checkpoint
  std::int64_t window;              ///< steps that may be unacknowledged, >= 1
  double stall_timeout;             ///< [s]; 0 = wait forever
  std::uint64_t number;  ///< number of the run in its launch, from 1: every change of an endless run begins another
  std::int64_t burn_in;  ///< steps left out of the time averages of an endless run, else of amplification.csv
  bool steps_chosen = false;               ///< steps is chosen_steps() instead of a given number
  bool burn_in_chosen = false;             ///< burn_in is settling_steps() instead of a given number
  std::vector<std::size_t> external = {};  ///< external vehicles, ascending
  std::vector<std::string> signals = {};   ///< beside the tracking errors, in the order of signal_kinds()

  /// Whether follower i is an external vehicle.
  bool is_external(std::size_t follower) const;

  /// The followers before the first external vehicle, which are those that the theory covers.
  std::size_t followers_before_external() const { return external.empty() ? followers : external.front() - 1; }

  /// The receivers that must acknowledge every step.
  std::vector<std::string> receivers() const;

  /// Whether amplification.csv is written: the speed is among the signals, and burn_in leaves two steps or more.
  bool has_amplification() const;

  /// Number of steps that the last vehicle may be ahead of the leader: see publishes_ahead().
  std::size_t pipeline_depth() const;

  BatchSchedule schedule() const { return {realizations, batch, steps}; }

  /// The kind of average that the run's statistics take.
  Averaging averaging() const { return steps == 0 ? Averaging::over_time : Averaging::over_realizations; }
};

/// Reads the options of a section and adds all problems to those of the section. batch, window: 0 selects the default.
RunOptions read_run_options(Section section);

/// The list `external` of a section: followers from 1 to `followers`, sorted. "none", which leaves out the external
/// vehicles of a recording that is repeated, gives an empty list.
std::vector<std::size_t> read_external(Section& section, std::size_t followers);

/// JSON for read_run_options().
nlohmann::json to_json(const RunOptions& options);

/// Default number of steps: these seconds of driving, from 100 to 10,000 steps and within the limits of a run.
std::int64_t chosen_steps(const RunOptions& options, double sample_period, double seconds);

/// Default number of realizations per message: 64 kB messages, or 256 kB with a recorder, whose cost per message is
/// higher; fewer for strings of hundreds of followers and more, so that the few steps in flight fit the memory.
std::uint64_t chosen_batch(const RunOptions& options);

/// Default number of steps in flight: enough to keep every process busy, within about 100 MB for the whole graph.
std::int64_t chosen_window(std::uint64_t batch, std::size_t followers);

}  // namespace platoon
