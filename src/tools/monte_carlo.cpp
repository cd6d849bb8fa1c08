// The platoon's Monte Carlo in one process, without ROS: the same vehicles, channels and statistics as in the nodes,
// with the same bits. Writes the same statistics.csv and summary.json, or a shard for merge; --repeat runs a
// summary.json again. A run that was interrupted or killed continues with the same command.

#include <atomic>
#include <charconv>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <optional>
#include <stdexcept>

#include "stochastic_platoon/run/configuration/configuration_document.hpp"
#include "stochastic_platoon/run/configuration/settings.hpp"
#include "stochastic_platoon/run/configuration/shipped_files.hpp"
#include "stochastic_platoon/run/io/atomic_file.hpp"
#include "stochastic_platoon/run/io/progress_display.hpp"
#include "stochastic_platoon/run/results/checkpoint.hpp"
#include "stochastic_platoon/run/results/provenance.hpp"
#include "stochastic_platoon/run/results/run_report.hpp"
#include "stochastic_platoon/run/results/trajectories_csv.hpp"
#include "stochastic_platoon/run/scaling/shard_run.hpp"
#include "stochastic_platoon/run/scaling/whole_run.hpp"
#include "tools/settings.hpp"

namespace {

constexpr int kInterrupted = 130;  // exit status, as the shell's after Ctrl-C

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Ctrl-C or a scheduler's SIGTERM stops the run after the batches that have begun; the same signal again ends the
// program at once.
std::atomic<bool> stop_requested{false};

void request_stop(int signal) {
  stop_requested = true;
  std::signal(signal, SIG_DFL);
}

// Shows the progress of a number of realizations, and checks for a stop request.
class Display {
public:
  Display(const platoon::RunOptions& run, std::uint64_t realizations)
      : display_(realizations, "realizations", static_cast<double>(run.followers) * static_cast<double>(run.steps),
                 "vehicle-steps") {}

  void connect(platoon::ShardSettings& settings) {
    settings.progress = [this](std::uint64_t done) { display_.update(done, now()); };
    settings.warn = [](const std::string& warning) { std::cerr << warning << "\n"; };
    settings.stop = [] { return stop_requested.load(); };
  }

  void finish() { display_.finish(); }

private:
  platoon::ProgressDisplay display_;
};

// Returns whether all realizations are done.
bool reported(const std::string& name, std::uint64_t done, std::uint64_t of) {
  if (done < of) {
    std::cout << name << ": stopped after " << done << " of " << of << " realizations: the same command continues\n";
  }
  return done == of;
}

// Returns whether the run is complete.
bool run_whole(const platoon::Configuration& configuration, platoon::ShardSettings settings) {
  Display display(configuration.run, configuration.run.realizations);
  display.connect(settings);
  const platoon::WholeRun run = platoon::compute_run(configuration, settings);
  display.finish();
  if (run.result.realizations > 0) {
    std::cout << platoon::report(configuration, run.prediction, run.result) << "Results: " << configuration.run.output
              << "/statistics.csv and summary.json\n";
  }
  return reported("monte_carlo", run.result.realizations, configuration.run.realizations);
}

// Returns whether the shard is complete.
bool run_shard(platoon::Configuration configuration, const std::string& text, platoon::ShardSettings settings) {
  platoon::RunOptions& options = configuration.run;
  const platoon::ShardRun shard{configuration, platoon::parse_shard(text, options.realizations)};
  const std::string name = platoon::name_of(shard.shard);
  // A restarted shard keeps its name, so that it takes over its folder and its lock.
  options.launch_id = name;
  const std::unique_ptr<platoon::FolderLock> lock = platoon::lock_output(options);
  const platoon::RealizationRange range = shard.range();
  Display display(options, range.size());
  display.connect(settings);
  const auto [checkpoint, computed] = platoon::compute_shard({configuration, shard.shard}, settings);
  display.finish();
  const std::uint64_t done = checkpoint.totals.count();
  if (done == range.size()) {
    std::cout << name << ": complete: realizations " << range.first << " to " << range.end - 1 << " of "
              << options.realizations << ", " << computed << " of them computed now: " << options.output << "\n";
  }
  return reported(name, done, range.size());
}

/// The configuration in the summary of a run, with another output folder. Throws ConfigurationError if it cannot be
/// repeated, or if a setting other than the folder is given.
platoon::RecordedResults repeated(const std::string& file, const std::map<std::string, std::string>& settings) {
  for (const auto& entry : settings) {
    if (entry.first != "output")
      throw platoon::ConfigurationError(
          {entry.first + ": given: must be absent beside repeat, which takes it from " + file});
  }
  platoon::RecordedResults recorded = platoon::read_summary(file);
  platoon::RunOptions& run = recorded.configuration.run;
  const auto reject = [&file](const std::string& reason) {
    throw platoon::ConfigurationError({file + ": " + reason + ": cannot be repeated"});
  };
  if (!recorded.complete) reject("is of an incomplete run");
  if (run.averaging() == platoon::Averaging::over_time) reject("is of averages over time");
  if (!run.external.empty()) reject("is of a run with external vehicles");
  run.output = settings.count("output") > 0 ? settings.at("output") : "";
  run.resume = false;
  run.record.clear();
  run.launch_id.clear();
  return recorded;
}

/// Throws std::runtime_error if the results differ from the recorded ones.
void require_equal(const platoon::RecordedResults& recorded, const std::string& output, const std::string& file) {
  const nlohmann::json found = platoon::read_summary(output + "/summary.json").checksums;
  for (const auto& [table, checksum] : recorded.checksums.items()) {
    if (found.value(table, nlohmann::json()) != checksum)
      throw std::runtime_error(output + "/" + table + ".csv: differs from the one that " + file + " describes");
    std::cout << table << ".csv equals the one that " << file << " describes, bit for bit.\n";
  }
}

// Writes the trajectories of one realization in place of a run.
void write_trajectories(const platoon::Configuration& configuration, const std::string& only) {
  std::uint64_t realization = 0;
  const auto read = std::from_chars(only.data(), only.data() + only.size(), realization);
  if (read.ec != std::errc() || read.ptr != only.data() + only.size())
    throw platoon::ConfigurationError({"only: " + only + ": must be the number of a realization, 0 or more"});
  const std::string text = platoon::trajectories_csv(configuration, realization),
                    file = configuration.run.output + "/trajectories.csv";
  const std::unique_ptr<platoon::FolderLock> lock = platoon::lock_output(configuration.run);
  if (std::filesystem::exists(file))
    throw platoon::ConfigurationError(
        {"output: " + file + ": exists and is never overwritten: must be another folder"});
  platoon::write_atomically(file, text);
  std::cout << "Realization " << realization << ": " << file << "\n";
}

}  // namespace

int main(int argc, char** argv) {
  const std::map<std::string, std::string> own_help = {
      {"threads", "worker threads (one per core); the result does not depend on it"},
      {"shard", "I/N: only part I = 0 .. N - 1 of the realizations, for merge"},
      {"checkpoint_seconds", "seconds between checkpoints (10), from which the same command continues"},
      {"repeat", "summary.json of a run: repeats it into another output folder and compares the results"},
      {"only", "number of a realization of the run: with --trajectories, instead of the run"},
      {"trajectories", "writes trajectories.csv: every position, input and signal of that realization"}};
  std::map<std::string, std::string> help = own_help;
  help["steps"] = "steps per realization, 1 or more (100)";
  help["batch"] = "realizations that a thread computes at once (" + std::string(platoon::kMonteCarloBatch) +
                  ", with signals " + platoon::kMonteCarloBatchWithSignals + ")";
  help["output"] = "folder for the results";
  help["burn_in"] = "steps that amplification.csv leaves out (none)";
  std::map<std::string, std::string> settings =
      platoon::parse_command_line(argc, argv, "Monte Carlo of the platoon in one process",
                                  {"model", "headway", "headway_seconds", "noise_variance", "loss", "mean_burst",
                                   "delay", "leader", "followers", "realizations", "seed", "signals"},
                                  help, nullptr, {"trajectories"});
  std::map<std::string, std::string> own;
  for (const auto& entry : own_help) {
    if (settings.count(entry.first) > 0) own[entry.first] = settings[entry.first];
    settings.erase(entry.first);
  }
  platoon::ignore_file_size_signal();
  for (const int signal : {SIGINT, SIGTERM}) {
    if (std::signal(signal, request_stop) == SIG_IGN) std::signal(signal, SIG_IGN);  // a job in the background
  }
  try {
    platoon::ShardSettings how;
    how.threads = platoon::threads_of(own["threads"]);
    if (own.count("checkpoint_seconds") > 0)
      how.checkpoint_seconds = platoon::seconds_of("checkpoint-seconds", own["checkpoint_seconds"]);
    std::optional<platoon::RecordedResults> recorded;
    if (own.count("repeat") > 0) recorded = repeated(own["repeat"], settings);
    settings.emplace("model", platoon::paper_model_file());
    platoon::add_monte_carlo_batch(settings);
    platoon::Configuration configuration =
        recorded ? recorded->configuration : platoon::parse_configuration(platoon::configuration_document(settings));
    configuration.run.hosting = platoon::Hosting::monte_carlo;
    if (configuration.run.averaging() == platoon::Averaging::over_time)
      throw platoon::ConfigurationError({"steps: 0: must be at least 1 for a Monte Carlo"});
    if (configuration.run.output.empty()) throw platoon::ConfigurationError({"output: (empty): must be a folder"});
    const std::optional<std::string> shard = own.count("shard") > 0 ? std::optional(own["shard"]) : std::nullopt;
    if (own.count("only") != own.count("trajectories"))
      throw platoon::ConfigurationError({std::string(own.count("only") > 0 ? "only" : "trajectories") +
                                         ": given: must be with --only and --trajectories"});
    if (own.count("only") > 0) {
      write_trajectories(configuration, own["only"]);
      return 0;
    }
    if (recorded && shard) throw platoon::ConfigurationError({"shard: given: must be absent beside repeat"});
    platoon::log_slow_noise(argv[0]);
    if (!(shard ? run_shard(configuration, *shard, how) : run_whole(configuration, how))) return kInterrupted;
    if (recorded) require_equal(*recorded, configuration.run.output, own["repeat"]);
    return 0;
  } catch (const std::exception& error) {
    std::cerr << argv[0] << ": " << error.what() << "\n";
    return 1;
  }
}
