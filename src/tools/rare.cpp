// The probability that a gap falls below a bound during a run, however small: by conditioned realizations or by
// splitting. Writes rare.csv and rare.json. An estimation that was interrupted or killed continues with the same
// command.

#include <unistd.h>

#include <iostream>

#include "stochastic_platoon/math/numerics/interruption.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/run/configuration/configuration_document.hpp"
#include "stochastic_platoon/run/configuration/settings.hpp"
#include "stochastic_platoon/run/configuration/single_number.hpp"
#include "stochastic_platoon/run/io/atomic_file.hpp"
#include "stochastic_platoon/run/io/clock.hpp"
#include "stochastic_platoon/run/io/progress_display.hpp"
#include "stochastic_platoon/run/scaling/merge.hpp"
#include "stochastic_platoon/run/scaling/rare_run.hpp"
#include "tools/command_line.hpp"
#include "tools/long_run.hpp"

namespace {

// Returns whether the estimation is complete.
bool run_whole(const platoon::RareRun& run, platoon::ShardSettings settings) {
  const platoon::ShardRun whole = run.shard({0, 1});
  platoon::ProgressDisplay display = platoon::display_of(whole);
  settings.progress = [&display](std::uint64_t done) { display.update(done, platoon::now()); };
  const platoon::RareResult result = platoon::compute_rare(run, settings);
  display.finish();
  const bool complete = platoon::reported("rare", result.samples, whole);
  if (complete)
    std::cout << result.report << "Results: " << run.configuration.run.output << "/rare.csv and rare.json\n";
  return complete;
}

// Writes the trajectories of one sample in place of an estimation.
void write_trajectories(const platoon::RareRun& run, const std::string& vehicle, const std::string& only) {
  const platoon::Interruptible by_signals = platoon::interruptible_by_signals();
  const platoon::RareReplay replay = platoon::rare_replay(run, vehicle, only);
  const std::string file = platoon::write_trajectories(run.configuration, replay.realization, replay.changes);
  std::cout << "A realization with a gap below " << run.options.below << " m: " << file << "\n";
}

// The estimation, after the pilot of a splitting, which may take long: it is displayed and ends at Ctrl-C.
template <typename... Arguments>
platoon::RareRun prepared(const Arguments&... of) {
  const platoon::Interruptible by_signals = platoon::interruptible_by_signals();
  platoon::ProgressDisplay display(1, "pilot", 1.0, "pilots");
  const platoon::Interruptible displayed(
      [&display] { display.prepare("rare: prepares the estimation", platoon::now()); });
  platoon::RareRun run = platoon::rare_run(of...);
  display.finish();
  return run;
}

// The configuration with the value of the key that satisfies the requirement.
platoon::Configuration fulfilling(const platoon::RareRequirement& requirement, const platoon::Configuration& base,
                                  const platoon::RareOptions& options, const platoon::ShardSettings& how,
                                  const platoon::CommandLine& given) {
  const auto with = [&](double value) {
    YAML::Node document = platoon::configuration_document(given.settings);
    platoon::override_value(document, requirement.over, YAML::Node(platoon::formatted("%.17g", value)));
    platoon::Configuration changed = platoon::parse_configuration(document);
    changed.run.hosting = platoon::Hosting::monte_carlo;
    return changed;
  };
  const platoon::VehicleModel& vehicle = base.model.default_vehicle();
  const std::string per = requirement.per_hour ? " per hour" : " per run";
  const double present = requirement.over == "time_headway" ? vehicle.headway : vehicle.standstill_distance;
  const double value = platoon::required_value(
      requirement, present > 0.0 ? present : 1.0, [&](double of) { return prepared(with(of), options, how.threads); },
      how,
      [&](double of, double figure) {
        if (::isatty(STDERR_FILENO) != 0)
          std::cerr << requirement.over << " " << of << ": " << figure << per << " at the upper 95 % limit\n";
      });
  std::cout << requirement.over << ": " << value << " for at most " << requirement.probability << per
            << ", any follower, at the upper 95 % limit "
            << (requirement.over == "time_headway" ? platoon::formatted("(%.6g s)", value * base.model.sample_period)
                                                   : std::string("(in m)"))
            << "\n";
  return with(value);
}

// The configuration without the values that override the model's numbers, if they hide it by their faults: it has the
// steps of the run.
std::optional<platoon::Configuration> configured_by_file(std::map<std::string, std::string> settings) {
  for (const platoon::Setting& setting : platoon::settings()) {
    if (setting.model_key != nullptr && setting.name != std::string("leader")) settings.erase(setting.name);
  }
  return platoon::ProblemCollector().result_of(
      [&] { return platoon::parse_configuration(platoon::configuration_document(settings)); });
}

// Shards have all settings but the output, and all options but the speed.
void require_no_others(const platoon::CommandLine& given) {
  platoon::ProblemCollector problems;
  for (const auto* entries : {&given.settings, &given.options}) {
    for (const auto& entry : *entries) {
      if (entry.first != "output" && entry.first != "speed")
        problems.add(entry.first + ": given: must be absent beside shards, whose own it is");
    }
  }
  problems.require_none();
}

void merge_into(const platoon::CommandLine& given) {
  require_no_others(given);
  const std::string& output = given.settings.at("output");
  platoon::MergedShards merged = platoon::merge_shards(given.words);
  if (merged.run.rare.is_null())
    throw platoon::ConfigurationError({"shards of monte_carlo: must be joined by merge DIR... --output DIR"});
  platoon::RareRun run = prepared(merged.run, platoon::threads_of(given));
  run.configuration.run.output = output;
  run.configuration.run.launch_id.clear();
  run.options.speed = platoon::rare_options(given.options).speed;
  const std::unique_ptr<platoon::FolderLock> lock = platoon::lock_output(run.configuration.run);
  platoon::starting_point(run.configuration);  // throws if the folder holds results, or a shard
  const platoon::RareResult result = platoon::rare_result(run, merged.totals);
  platoon::write_rare(output, result);
  std::cout << result.report << "Results: " << output << "/rare.csv and rare.json\n";
}

}  // namespace

int rare_main(int argc, char** argv) {
  const platoon::CommandLine given = platoon::parse_command_line(
      argc, argv,
      {"Probabilities of small gaps, however small; rare DIR... --output DIR joins the shards of one estimation\n"
       "Example: rare --model paper_at_rest.yaml --followers 5 --output /tmp/rare",
       {"model", "headway", "headway_seconds", "noise_variance", "loss", "mean_burst", "delay", "leader", "followers",
        "steps", "realizations", "seed", "output", "burn_in"},
       {{"below", "a gap below this bound [m] is the event (0)"},
        {"method",
         "condition: conditioned realizations, for links with normal errors; split: splitting by levels, for losses, quantisation and limits; auto: by the model (auto)"},
        {"required",
         "probability of a small gap of any follower: finds the smallest --over, to 0.1 %, whose upper 95 % limit satisfies it, and estimates there"},
        {"per", "with --required: run or hour (run)"},
        {"over", "with --required: standstill_distance or time_headway, of the default vehicle (standstill_distance)"},
        {"speed", "[m/s]: rare.json also has probabilities per kilometre at this speed"},
        {"trajectories", "instead of an estimation: writes trajectories.csv of a realization with the event"},
        {"vehicle", "with --trajectories: the follower whose gap is small, or any (any)"},
        {"only",
         "with --trajectories: number of a conditioned realization or of a repetition; without it the most likely realization, or the first repetition"},
        {"threads", platoon::kThreadsHelp},
        {"shard", platoon::kShardHelp + std::string("; rare DIR... --output DIR joins the parts")},
        {"checkpoint_seconds", platoon::kCheckpointHelp}},
       true,
       {"trajectories"},
       {{"steps", platoon::kStepsHelp},
        {"realizations", "realizations per follower, or per level of a splitting (10000)"},
        {"output", "folder for the results; required"},
        {"burn_in", "steps at the start in which a small gap does not count (0)"}}});
  platoon::ignore_file_size_signal();
  platoon::stop_on_signals();
  try {
    platoon::ProblemCollector problems;
    const std::string output = given.setting("output");
    problems.check([&] { platoon::require_possible_output(output, given.has("shard")); });
    if (!given.words.empty()) {
      problems.require_none();
      merge_into(given);
      return 0;
    }
    const auto found = problems.result_of(
        [&] { return platoon::parse_configuration(platoon::configuration_document(given.settings)); });
    const auto options = problems.result_of([&] { return platoon::rare_options(given.options); });
    const auto asked = problems.result_of([&] { return platoon::rare_requirement(given.options); });
    const auto how = problems.result_of([&] { return platoon::shard_settings(given); });
    for (const char* name : {"vehicle", "only"}) {
      if (given.has(name) && !given.has("trajectories"))
        problems.add(std::string(name) + ": given: must be with --trajectories");
    }
    if (!given.has("shard") && !given.has("trajectories"))
      problems.check([&] { platoon::require_no_rare_results(output); });
    if (given.has("shard") && given.has("trajectories"))
      problems.add("shard: given: must be absent beside trajectories");
    problems.check([&] {
      if (given.has("shard")) platoon::parse_shard(given["shard"]);  // before any work; below against the samples
    });
    const auto judged = found ? found : configured_by_file(given.settings);
    problems.check([&] {
      if (!judged) return platoon::require_steps(given, "here");
      platoon::require_applicable(*judged, found && options ? *options : platoon::RareOptions{0.0, "auto", {}});
    });
    problems.check(
        [&] { platoon::rare_row(given["vehicle"], judged ? judged->run.followers : platoon::kMaxFollowers); });
    problems.check([&] {  // before any work; below against the samples
      if (given.has("only")) platoon::integer_of("only", given["only"], 0, platoon::kMaxCount);
    });
    problems.require_none();
    const std::optional<platoon::RareRequirement>& requirement = *asked;
    platoon::Configuration configuration = *found;
    configuration.run.hosting = platoon::Hosting::monte_carlo;
    if (requirement && given.has("shard")) platoon::require_no_rare_results(output);
    if (requirement) configuration = fulfilling(*requirement, configuration, *options, *how, given);
    const platoon::RareRun run = prepared(configuration, *options, how->threads);
    if (!requirement) platoon::require_an_estimate(run);
    if (given.has("trajectories")) {
      write_trajectories(run, given["vehicle"], given["only"]);
      return 0;
    }
    const bool complete =
        given.has("shard")
            ? platoon::run_shard(run.shard(platoon::parse_shard(given["shard"], run.samples())), *how, run.work())
            : run_whole(run, *how);
    return complete ? 0 : platoon::kInterrupted;
  } catch (const platoon::Interrupted&) {
    std::cout << "rare: stopped after 0 realizations: the same command begins again\n";
    return platoon::kInterrupted;
  } catch (const std::exception& error) {
    std::cerr << argv[0] << ": " << error.what() << "\n";
    return 1;
  }
}
