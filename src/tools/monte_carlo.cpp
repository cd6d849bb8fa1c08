// The platoon's Monte Carlo in one process, without ROS: the same vehicles, channels and statistics as the
// nodes', and the same bits. Writes the same statistics.csv and summary.json.

#include <algorithm>
#include <chrono>
#include <iostream>
#include <thread>

#include "stochastic_platoon/io/progress_display.hpp"
#include "stochastic_platoon/results/checkpoint.hpp"
#include "stochastic_platoon/results/run_report.hpp"
#include "stochastic_platoon/simulation/platoon_string.hpp"
#include "tools/settings.hpp"

namespace {

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

platoon::RunResult run(const platoon::Configuration& configuration, unsigned threads) {
  const platoon::RunOptions& options = configuration.run;
  platoon::ProgressDisplay display(
      options.realizations, "realizations",
      static_cast<double>(options.followers) * static_cast<double>(options.steps), "vehicle-steps");
  const double began = now();
  const platoon::MomentTable table = platoon::monte_carlo(
      configuration.model,
      {options.seed, options.followers, options.steps, options.realizations, options.batch}, threads,
      [&display](std::uint64_t done) { display.update(done, now()); });
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

// One per core where nothing is asked for.
unsigned threads_of(const std::string& text) {
  if (text.empty()) return std::max(std::thread::hardware_concurrency(), 1u);
  YAML::Node node;
  node["threads"] = text;
  std::vector<std::string> problems;
  const std::int64_t threads = platoon::Section(node, "", problems).integer("threads", 1, 1024);
  if (!problems.empty()) throw platoon::ConfigurationError(problems);
  return static_cast<unsigned>(threads);
}

}  // namespace

int main(int argc, char** argv) {
  std::map<std::string, std::string> settings = platoon::parse_command_line(
      argc, argv, "Monte Carlo of the platoon in one process",
      {"model", "headway", "noise_variance", "loss", "delay", "followers", "steps", "realizations", "batch",
       "seed", "output"},
      {{"threads", "worker threads (one per core); the result does not depend on it"}});
  const std::string threads_text = settings.count("threads") > 0 ? settings["threads"] : "";
  settings.erase("threads");
  try {
    const unsigned threads = threads_of(threads_text);
    settings.emplace("model", platoon::paper_model_file());
    settings.emplace("batch", "512");  // what a vehicle needs of so many fits the second level cache
    platoon::Configuration configuration =
        platoon::parse_configuration(platoon::configuration_document(settings));
    configuration.run.hosting = platoon::Hosting::monte_carlo;
    if (configuration.run.averaging() == platoon::Averaging::over_time)
      throw platoon::ConfigurationError({"steps: 0: must be at least 1 for a Monte Carlo"});
    if (configuration.run.output.empty())
      throw platoon::ConfigurationError({"output: (empty): must be a folder"});
    const std::unique_ptr<platoon::FolderLock> lock = platoon::lock_output(configuration.run);
    if (platoon::starting_point(configuration))
      throw std::logic_error("a fresh folder cannot hold a checkpoint");
    const platoon::Prediction prediction = platoon::predict(configuration);
    const platoon::RunResult result = run(configuration, threads);
    platoon::write_results(configuration, prediction, result);
    std::cout << platoon::report(configuration, prediction, result) << "Results: " << configuration.run.output
              << "/statistics.csv and summary.json\n";
    return 0;
  } catch (const std::exception& error) {
    std::cerr << argv[0] << ": " << error.what() << "\n";
    return 1;
  }
}
