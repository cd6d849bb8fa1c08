// The platoon's Monte Carlo in one process, without ROS: the same vehicles, channels and statistics as in the nodes,
// with the same bits. Writes the same statistics.csv and summary.json, or a shard for merge; --repeat runs a
// summary.json again.

#include <chrono>
#include <iostream>
#include <optional>
#include <stdexcept>

#include "stochastic_platoon/math/simulation/ensemble_run.hpp"
#include "stochastic_platoon/run/configuration/settings.hpp"
#include "stochastic_platoon/run/io/atomic_file.hpp"
#include "stochastic_platoon/run/io/progress_display.hpp"
#include "stochastic_platoon/run/results/checkpoint.hpp"
#include "stochastic_platoon/run/results/provenance.hpp"
#include "stochastic_platoon/run/results/run_report.hpp"
#include "stochastic_platoon/run/scaling/shard_run.hpp"
#include "tools/settings.hpp"

namespace {

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

platoon::ProgressDisplay display_of(const platoon::RunOptions& options, std::uint64_t realizations) {
  return {realizations, "realizations", static_cast<double>(options.followers) * static_cast<double>(options.steps),
          "vehicle-steps"};
}

platoon::RunResult run(const platoon::Configuration& configuration, unsigned threads) {
  const platoon::RunOptions& options = configuration.run;
  platoon::ProgressDisplay display = display_of(options, options.realizations);
  const double began = now();
  const platoon::MomentTable table = platoon::monte_carlo(
      configuration.model, {options.seed, options.followers, options.steps, options.realizations, options.batch},
      threads, [&display](std::uint64_t done) { display.update(done, now()); });
  display.finish();
  platoon::RunResult result;
  result.complete = true;
  result.realizations = options.realizations;
  result.tally.wall_seconds = now() - began;
  result.tally.positions_received = platoon::positions_expected(options, options.realizations);
  result.tally.attempts = 1;
  result.moments = table.totals();
  return result;
}

void run_whole(const platoon::Configuration& configuration, unsigned threads) {
  const std::unique_ptr<platoon::FolderLock> lock = platoon::lock_output(configuration.run);
  if (platoon::starting_point(configuration)) throw std::logic_error("a fresh folder cannot hold a checkpoint");
  const platoon::Prediction prediction = platoon::predict(configuration);
  const platoon::RunResult result = run(configuration, threads);
  platoon::write_results(configuration, prediction, result);
  std::cout << platoon::report(configuration, prediction, result) << "Results: " << configuration.run.output
            << "/statistics.csv and summary.json\n";
}

void run_shard(platoon::Configuration configuration, const std::string& text, const std::string& seconds,
               unsigned threads) {
  const platoon::Shard shard = platoon::parse_shard(text, configuration.run.realizations);
  // A restarted shard keeps its name, so that it takes over its folder and its lock.
  configuration.run.launch_id = platoon::name_of(shard);
  const platoon::ShardRun part{configuration, shard};
  const platoon::RealizationRange range = part.range();
  platoon::ProgressDisplay display = display_of(configuration.run, range.size());
  platoon::ShardSettings settings;
  settings.threads = threads;
  if (!seconds.empty()) settings.checkpoint_seconds = platoon::seconds_of("checkpoint-seconds", seconds);
  settings.progress = [&display](std::uint64_t done) { display.update(done, now()); };
  settings.warn = [](const std::string& warning) { std::cerr << warning << "\n"; };
  const std::uint64_t computed = platoon::compute_shard(part, settings);
  display.finish();
  std::cout << platoon::name_of(shard) << ": complete: realizations " << range.first << " to " << range.end - 1
            << " of " << configuration.run.realizations << ", " << computed
            << " of them computed now: " << configuration.run.output << "\n";
}

/// The configuration that the summary of a run states, with another output folder. Throws ConfigurationError if it
/// cannot be repeated, or if a setting other than the folder is given.
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
  if (platoon::read_summary(output + "/summary.json").statistics_checksum != recorded.statistics_checksum)
    throw std::runtime_error(output + "/statistics.csv: differs from the one that " + file + " describes");
  std::cout << "statistics.csv equals the one that " << file << " describes, bit for bit.\n";
}

}  // namespace

int main(int argc, char** argv) {
  const std::map<std::string, std::string> extra = {
      {"threads", "worker threads (one per core); the result does not depend on it"},
      {"shard", "I/N: only part I = 0 .. N - 1 of the realizations, for merge; goes on from what it has left"},
      {"checkpoint_seconds", "seconds between checkpoints of a shard (10)"},
      {"repeat", "summary.json of a run: repeats it into another output folder and compares the results"}};
  std::map<std::string, std::string> settings =
      platoon::parse_command_line(argc, argv, "Monte Carlo of the platoon in one process",
                                  {"model", "headway", "noise_variance", "loss", "delay", "followers", "steps",
                                   "realizations", "batch", "seed", "output"},
                                  extra);
  std::map<std::string, std::string> own;
  for (const auto& entry : extra) {
    if (settings.count(entry.first) > 0) own[entry.first] = settings[entry.first];
    settings.erase(entry.first);
  }
  platoon::ignore_file_size_signal();
  try {
    const unsigned threads = platoon::threads_of(own["threads"]);
    std::optional<platoon::RecordedResults> recorded;
    if (own.count("repeat") > 0) recorded = repeated(own["repeat"], settings);
    settings.emplace("model", platoon::paper_model_file());
    settings.emplace("batch", platoon::kMonteCarloBatch);
    platoon::Configuration configuration =
        recorded ? recorded->configuration : platoon::parse_configuration(platoon::configuration_document(settings));
    configuration.run.hosting = platoon::Hosting::monte_carlo;
    if (configuration.run.averaging() == platoon::Averaging::over_time)
      throw platoon::ConfigurationError({"steps: 0: must be at least 1 for a Monte Carlo"});
    if (configuration.run.output.empty()) throw platoon::ConfigurationError({"output: (empty): must be a folder"});
    if (recorded && own.count("shard") > 0)
      throw platoon::ConfigurationError({"shard: given: must be absent beside repeat"});
    platoon::log_slow_noise(argv[0]);
    if (own.count("shard") > 0) {
      run_shard(configuration, own["shard"], own["checkpoint_seconds"], threads);
    } else if (own.count("checkpoint_seconds") > 0) {
      throw platoon::ConfigurationError({"checkpoint-seconds: given: must go with --shard"});
    } else {
      run_whole(configuration, threads);
      if (recorded) require_equal(*recorded, configuration.run.output, own["repeat"]);
    }
    return 0;
  } catch (const std::exception& error) {
    std::cerr << argv[0] << ": " << error.what() << "\n";
    return 1;
  }
}
