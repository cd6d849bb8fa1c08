// The platoon's Monte Carlo in one process, without ROS: the same vehicles, channels and statistics as in the nodes,
// with the same bits. Writes the same statistics.csv and summary.json, or a shard for merge; --repeat runs a
// summary.json again. A run that was interrupted or killed continues with the same command.

#include <iostream>
#include <optional>
#include <stdexcept>

#include "stochastic_platoon/run/configuration/configuration_document.hpp"
#include "stochastic_platoon/run/configuration/settings.hpp"
#include "stochastic_platoon/run/configuration/single_number.hpp"
#include "stochastic_platoon/run/io/atomic_file.hpp"
#include "stochastic_platoon/run/io/clock.hpp"
#include "stochastic_platoon/run/io/read_file.hpp"
#include "stochastic_platoon/run/results/checkpoint.hpp"
#include "stochastic_platoon/run/results/provenance.hpp"
#include "stochastic_platoon/run/results/run_report.hpp"
#include "stochastic_platoon/run/scaling/whole_run.hpp"
#include "tools/command_line.hpp"
#include "tools/long_run.hpp"

namespace {

// Returns whether the run is complete.
bool run_whole(const platoon::Configuration& configuration, platoon::ShardSettings settings) {
  const platoon::ShardRun whole{configuration, {0, 1}};
  platoon::ProgressDisplay display = platoon::display_of(whole);
  settings.progress = [&display](std::uint64_t done) { display.update(done, platoon::now()); };
  const platoon::WholeRun run = platoon::compute_run(configuration, settings);
  display.finish();
  if (run.result.realizations > 0) {
    std::cout << platoon::report(configuration, run.prediction, run.result);
  }
  if (!run.unsaved.empty()) throw std::runtime_error(run.unsaved);
  if (run.result.realizations > 0)
    std::cout << "Results: " << configuration.run.output << "/statistics.csv and summary.json\n";
  return platoon::reported("monte_carlo", run.result.realizations, whole);
}

/// The configuration in the summary of a run, with another output folder. Throws ConfigurationError if it cannot be
/// repeated, or if a setting other than the folder is given.
platoon::RecordedResults repeated(const std::string& file, const std::map<std::string, std::string>& settings) {
  platoon::ProblemCollector problems;
  for (const auto& entry : settings) {
    if (entry.first != "output")
      problems.add(entry.first + ": given: must be absent beside repeat, which takes it from " + file);
  }
  problems.require_none();
  platoon::RecordedResults recorded = platoon::read_summary(file);
  platoon::RunOptions& run = recorded.configuration.run;
  const auto reject = [&file](const std::string& reason) {
    throw platoon::ConfigurationError({file + ": " + reason + ": cannot be repeated"});
  };
  if (!recorded.complete) reject("is of an incomplete run");
  if (run.averaging() == platoon::Averaging::over_time) reject("is of averages over time");
  if (const std::string part = platoon::part_of_run(run, recorded.realizations); !part.empty()) reject("is of " + part);
  if (!run.external.empty()) reject("is of a run with external vehicles");
  run.output = settings.count("output") > 0 ? settings.at("output") : "";
  run.resume = false;
  run.record.clear();
  run.launch_id.clear();
  recorded.configuration.version = platoon::kVersion;
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

// Throws ConfigurationError.
platoon::Configuration configured(const platoon::CommandLine& given) {
  std::map<std::string, std::string> settings = given.settings;
  platoon::add_monte_carlo_batch(settings);
  platoon::ProblemCollector problems;
  auto configuration =
      problems.result_of([&] { return platoon::parse_configuration(platoon::configuration_document(settings)); });
  problems.check([&] { platoon::require_steps(given, "for a Monte Carlo"); });
  problems.require_none();
  return *configuration;
}

}  // namespace

int monte_carlo_main(int argc, char** argv) {
  const platoon::CommandLine given = platoon::parse_command_line(
      argc, argv,
      {"Monte Carlo of the platoon in one process\n"
       "Example: monte_carlo --model acc.yaml --realizations 1e5 --output /tmp/acc",
       {"model", "headway", "headway_seconds", "noise_variance", "loss", "mean_burst", "delay", "leader", "followers",
        "steps", "realizations", "batch", "seed", "signals", "output", "burn_in"},
       {{"threads", platoon::kThreadsHelp},
        {"shard", platoon::kShardHelp + std::string(", for merge")},
        {"checkpoint_seconds", platoon::kCheckpointHelp},
        {"repeat", "summary.json of a run: repeats it into another output folder and compares the results"},
        {"only", "number of a realization of the run: with --trajectories, instead of the run"},
        {"trajectories", "writes trajectories.csv: every position, input and signal of that realization"}},
       false,
       {"trajectories"},
       {{"steps", platoon::kStepsHelp},
        {"batch", std::string("realizations that a thread computes at once (") + platoon::kMonteCarloBatch +
                      ", with signals " + platoon::kMonteCarloBatchWithSignals + ")"},
        {"output", "folder for the results; required"},
        {"burn_in", "steps that amplification.csv leaves out (none)"}}});
  platoon::ignore_file_size_signal();
  platoon::stop_on_signals();
  try {
    platoon::ProblemCollector problems;
    const auto how = problems.result_of([&] { return platoon::shard_settings(given); });
    std::optional<platoon::RecordedResults> recorded;
    const auto found = problems.result_of([&] {
      if (!given.has("repeat")) return configured(given);
      recorded = repeated(given["repeat"], given.settings);
      return recorded->configuration;
    });
    problems.check([&] { platoon::require_possible_output(given.setting("output"), !given.has("only")); });
    if (given.has("only") != given.has("trajectories"))
      problems.add(given.has("only") ? "only: given: must be with --trajectories"
                                     : "trajectories: given: must be with --only");
    for (const char* other : {"only", "repeat"}) {
      if (given.has(other) && given.has("shard"))
        problems.add(std::string("shard: given: must be absent beside ") + other);
    }
    // Read before a ShardRun begins: GCC ends the lifetime of a half-made one before it destroys it.
    const auto shard = problems.result_of([&] {
      if (!given.has("shard")) return platoon::Shard{0, 1};
      return platoon::parse_shard(given["shard"], found ? found->run.realizations : platoon::kMostShards);
    });
    const auto only = problems.result_of([&] {
      if (!given.has("only")) return std::int64_t{0};
      const auto realizations = found ? static_cast<std::int64_t>(found->run.realizations) : platoon::kMaxCount;
      return platoon::integer_of("only", given["only"], 0, realizations - 1);
    });
    problems.require_none();
    platoon::Configuration configuration = *found;
    configuration.run.hosting = platoon::Hosting::monte_carlo;
    if (given.has("only")) {
      const platoon::Interruptible by_signals = platoon::interruptible_by_signals();
      const std::string file = platoon::write_trajectories(configuration, static_cast<std::uint64_t>(*only));
      std::cout << "Realization " << *only << ": " << file << "\n";
      return 0;
    }
    bool complete = false;
    if (given.has("shard")) {
      complete = platoon::run_shard({configuration, *shard}, *how,
                                    platoon::batch_work(configuration.model, platoon::ensemble_of(configuration.run)));
    } else {
      complete = run_whole(configuration, *how);
    }
    if (!complete) return platoon::kInterrupted;
    if (recorded) require_equal(*recorded, configuration.run.output, given["repeat"]);
    return 0;
  } catch (const platoon::Interrupted&) {
    std::cout << "monte_carlo: stopped: the same command starts again\n";
    return platoon::kInterrupted;
  } catch (const std::exception& error) {
    std::cerr << argv[0] << ": " << error.what() << "\n";
    return 1;
  }
}
