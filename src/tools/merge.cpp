// Joins the shards computed by monte_carlo --shard: bit for bit the results of one run.

#include <iostream>

#include "stochastic_platoon/run/io/atomic_file.hpp"
#include "stochastic_platoon/run/results/checkpoint.hpp"
#include "stochastic_platoon/run/results/result_files.hpp"
#include "stochastic_platoon/run/results/run_report.hpp"
#include "stochastic_platoon/run/scaling/merge.hpp"
#include "tools/command_line.hpp"

int merge_main(int argc, char** argv) {
  const platoon::CommandLine given =
      platoon::parse_command_line(argc, argv,
                                  {"merge DIR... --output DIR: the shards of a run, joined to the results of one\n"
                                   "Example: merge /tmp/shard-* --output /tmp/whole",
                                   {},
                                   {{"output", "folder for the results"}},
                                   true});
  platoon::ignore_file_size_signal();
  try {
    if (given.words.empty() || !given.has("output"))
      throw platoon::ConfigurationError(
          {"merge DIR... --output DIR: must be given the folders of the shards, and one for the results"});
    platoon::MergedRun merged = platoon::merge(given.words);
    platoon::Configuration& configuration = merged.configuration;
    configuration.run.output = given["output"];
    configuration.run.resume = false;
    configuration.run.launch_id.clear();
    const std::unique_ptr<platoon::FolderLock> lock = platoon::lock_output(configuration.run);
    platoon::starting_point(configuration);  // throws if the folder holds results
    const platoon::Prediction prediction = platoon::predict(configuration);
    platoon::write_results(configuration, prediction, merged.result);
    std::cout << platoon::report(configuration, prediction, merged.result) << "Results: " << configuration.run.output
              << "/statistics.csv and summary.json\n";
    return 0;
  } catch (const std::exception& error) {
    std::cerr << argv[0] << ": " << error.what() << "\n";
    return 1;
  }
}
