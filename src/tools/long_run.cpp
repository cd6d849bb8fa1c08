#include "tools/long_run.hpp"

#include <atomic>
#include <csignal>
#include <iostream>
#include <stdexcept>

#include "stochastic_platoon/run/configuration/single_number.hpp"
#include "stochastic_platoon/run/io/clock.hpp"
#include "stochastic_platoon/run/io/read_file.hpp"
#include "stochastic_platoon/run/results/checkpoint.hpp"
#include "stochastic_platoon/run/results/provenance.hpp"
#include "stochastic_platoon/run/results/result_files.hpp"
#include "stochastic_platoon/run/results/trajectories_csv.hpp"

namespace platoon {

namespace {

std::atomic<bool> stopping{false};

void request_stop(int signal) {
  stopping = true;
  std::signal(signal, SIG_DFL);
}

}  // namespace

const char *const kThreadsHelp = "worker threads (one per core); the result does not depend on it",
                  *const kShardHelp = "I/N: only part I = 0 .. N - 1 of the realizations",
                  *const kCheckpointHelp = "seconds between checkpoints (10), from which the same command continues";

void stop_on_signals() {
  for (const int signal : {SIGINT, SIGTERM}) {
    if (std::signal(signal, request_stop) == SIG_IGN) std::signal(signal, SIG_IGN);  // a job in the background
  }
}

bool stop_requested() {
  return stopping;
}

Interruptible interruptible_by_signals() {
  return Interruptible([] {
    if (stopping) throw Interrupted();
  });
}

std::string write_trajectories(const Configuration& configuration, std::uint64_t realization,
                               const std::shared_ptr<const ChangedDraws>& changes) {
  const std::string& output = configuration.run.output;
  const std::string file = output + "/trajectories.csv";
  const std::unique_ptr<FolderLock> lock = lock_output(configuration.run);
  std::string csv = trajectories_csv(configuration, realization, changes);
  if (may_exist(file))
    throw ConfigurationError({"output: " + file + ": exists and is never overwritten: must be another folder"});
  nlohmann::json summary = provenance(configuration);
  summary["realization"] = realization;
  write_table(output, "trajectories", std::move(summary), std::move(csv));
  return file;
}

ShardSettings shard_settings(const CommandLine& given) {
  ShardSettings how;
  ProblemCollector problems;
  how.threads = problems.result_of([&] { return threads_of(given); }).value_or(1);
  how.warn = [](const std::string& warning) { std::cerr << warning << "\n"; };
  how.stop = stop_requested;
  how.stop_seconds = 0.5;  // a batch of many vehicles, or a repetition of a splitting, may take minutes
  problems.check([&] {
    if (given.has("checkpoint_seconds"))
      how.checkpoint_seconds = number_of(option_name("checkpoint_seconds"), given["checkpoint_seconds"], kPositive);
  });
  problems.require_none();
  return how;
}

ProgressDisplay display_of(const ShardRun& run) {
  const RunOptions& options = run.configuration.run;
  const std::uint64_t samples = run.range().size();
  if (run.rare.is_object()) return {samples, run.unit(), 1.0, run.unit()};
  return {samples, run.unit(), static_cast<double>(options.followers) * static_cast<double>(options.steps),
          "vehicle-steps"};
}

bool reported(const std::string& name, std::uint64_t done, const ShardRun& run) {
  const std::uint64_t of = run.range().size();
  if (done < of)
    std::cout << name << ": stopped after " << done << " of " << of << " " << run.unit()
              << ": the same command continues\n";
  return done == of;
}

bool run_shard(ShardRun run, ShardSettings settings, const BatchWork& computation) {
  RunOptions& options = run.configuration.run;
  const std::string name = name_of(run.shard);
  // A restarted shard keeps its name, so that it takes over its folder and its lock.
  options.launch_id = name;
  const std::unique_ptr<FolderLock> lock = lock_output(options);
  const RealizationRange range = run.range();
  ProgressDisplay display = display_of(run);
  settings.progress = [&display](std::uint64_t done) { display.update(done, now()); };
  const auto [checkpoint, computed, unsaved] = compute_shard(run, settings, computation);
  display.finish();
  if (!unsaved.empty()) throw std::runtime_error(unsaved);
  const std::uint64_t done = checkpoint.totals.count();
  if (done == range.size()) {
    std::cout << name << ": complete: " << run.unit() << " " << range.first << " to " << range.end - 1 << " of "
              << run.samples() << ", " << computed << " of them computed now: " << options.output << "\n";
  }
  return reported(name, done, run);
}

}  // namespace platoon
