// A sweep of runs: reads the axes from a file and writes one table. Runs on all cores of this machine, or task by task
// as an array of a cluster's scheduler.

#include <algorithm>
#include <iostream>

#include "stochastic_platoon/run/configuration/single_number.hpp"
#include "stochastic_platoon/run/io/atomic_file.hpp"
#include "stochastic_platoon/run/io/clock.hpp"
#include "stochastic_platoon/run/io/progress_display.hpp"
#include "stochastic_platoon/run/results/checkpoint.hpp"
#include "stochastic_platoon/run/scaling/shard_run.hpp"
#include "stochastic_platoon/run/scaling/sweep_file.hpp"
#include "stochastic_platoon/run/scaling/sweep_results.hpp"
#include "stochastic_platoon/run/scaling/sweep_run.hpp"
#include "tools/command_line.hpp"

namespace {

void warn(const std::string& text) {
  std::cerr << text << "\n";
}

// Locks the folder of the sweep for this process.
std::unique_ptr<platoon::FolderLock> lock_folder(const std::string& output) {
  platoon::RunOptions run{};
  run.output = output;
  run.launch_id = "sweep";  // a restarted sweep takes its folder again at once
  std::unique_ptr<platoon::FolderLock> lock = platoon::lock_output(run);
  platoon::require_no_results(output);
  platoon::require_writable_folder(output + "/points");
  return lock;
}

void compute(const platoon::Sweep& sweep, const std::vector<std::uint64_t>& points, platoon::SweepSettings settings) {
  std::uint64_t realizations = 0;
  double vehicle_steps = 0.0;
  for (const std::uint64_t point : points) {
    const platoon::RunOptions run = sweep.configuration(point).run;
    realizations += run.realizations;
    vehicle_steps +=
        static_cast<double>(run.realizations) * static_cast<double>(run.followers) * static_cast<double>(run.steps);
  }
  platoon::ProgressDisplay display(std::max<std::uint64_t>(realizations, 1), "realizations",
                                   vehicle_steps / static_cast<double>(std::max<std::uint64_t>(realizations, 1)),
                                   "vehicle-steps");
  settings.progress = [&](std::uint64_t done, const std::string& point) {
    display.set_note(point);
    display.update(done, platoon::now());
  };
  platoon::compute_points(sweep, points, settings);
  display.finish();
}

void run_task(const platoon::Sweep& sweep, std::uint64_t task, const platoon::SweepSettings& settings) {
  const std::uint64_t point = task / sweep.shards;
  const platoon::Shard shard{task % sweep.shards, sweep.shards};
  platoon::ShardRun part{sweep.configuration(point), shard};
  part.configuration.run.output = platoon::shard_folder(settings.output, point, shard.index);
  part.configuration.run.launch_id = platoon::name_of(shard);
  platoon::ShardSettings how;
  how.threads = settings.threads;
  how.warn = warn;
  const std::unique_ptr<platoon::FolderLock> lock = platoon::lock_output(part.configuration.run);
  const platoon::ShardResult result = platoon::compute_shard(part, how);
  if (!result.unsaved.empty()) throw std::runtime_error(result.unsaved);
  std::cout << "task " << task << ": point " << point << " (" << sweep.name_of(point) << "), "
            << platoon::name_of(shard) << ": complete, " << result.computed << " realizations computed now\n";
}

}  // namespace

int sweep_main(int argc, char** argv) {
  const platoon::CommandLine given = platoon::parse_command_line(
      argc, argv,
      {"sweep FILE --output DIR: a table of the runs in the file\n"
       "Example: sweep config/sweeps/headway.yaml --output /tmp/tails --realizations 1e4",
       {"realizations"},
       {{"output", "folder for sweep.csv and checkpoints"},
        {"threads", "worker threads (one per core); the result does not depend on it"},
        {"task",
         "as an array of jobs: number of the task to compute (point x shards + shard); count: print how many there are; merge: join their results to the table"}},
       true});
  platoon::ignore_file_size_signal();
  try {
    if (given.words.size() != 1) throw platoon::ConfigurationError({"sweep FILE --output DIR: must be given one file"});
    const std::string task = given["task"];
    platoon::ProblemCollector problems;
    const auto found = problems.result_of([&] { return platoon::read_sweep(given.words.front(), given.settings); });
    const auto threads = problems.result_of([&] { return platoon::threads_of(given); });
    const bool is_number = !task.empty() && task != "count" && task != "merge";
    const auto number = problems.result_of([&] {
      constexpr std::uint64_t kMost = platoon::Sweep::kMostPoints * platoon::kMostShards;
      const std::uint64_t tasks = found ? found->tasks() : kMost;
      return is_number ? platoon::integer_of("task", task, 0, static_cast<std::int64_t>(tasks) - 1) : 0;
    });
    if (task != "count") problems.check([&] { platoon::require_possible_output(given["output"], !is_number); });
    problems.require_none();
    const platoon::Sweep& sweep = *found;
    if (task == "count") {
      std::cout << sweep.tasks() << "\n";
      return 0;
    }
    platoon::SweepSettings settings;
    settings.output = given["output"];
    settings.threads = *threads;
    settings.warn = warn;
    if (is_number) {
      run_task(sweep, static_cast<std::uint64_t>(*number), settings);
      return 0;
    }
    const std::unique_ptr<platoon::FolderLock> lock = lock_folder(settings.output);
    const std::vector<std::uint64_t> missing = platoon::missing_points(sweep, settings);
    std::cout << sweep.points() << " points, " << missing.size() << " of them to "
              << (task.empty() ? "compute" : "merge") << "\n";
    if (task.empty()) {
      compute(sweep, missing, settings);
    } else {
      platoon::merge_points(sweep, missing, settings);
    }
    platoon::write_sweep(sweep, settings.output);
    std::cout << "Results: " << settings.output << "/sweep.csv\n";
    return 0;
  } catch (const std::exception& error) {
    std::cerr << argv[0] << ": " << error.what() << "\n";
    return 1;
  }
}
