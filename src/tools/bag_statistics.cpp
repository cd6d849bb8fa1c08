// The results of a recorded run, directly from its bag and without a master: bit for bit the same statistics.csv and
// summary.json.

#include <malloc.h>

#include <iostream>
#include <optional>

#include "stochastic_platoon/ros/bags/bag_statistics.hpp"
#include "stochastic_platoon/run/io/clock.hpp"
#include "stochastic_platoon/run/io/printable.hpp"
#include "stochastic_platoon/run/io/progress_display.hpp"
#include "stochastic_platoon/run/results/result_files.hpp"
#include "stochastic_platoon/run/results/run_report.hpp"
#include "tools/command_line.hpp"

namespace {

platoon::BagStatistics read(const platoon::CommandLine& given) {
  std::optional<std::vector<std::string>> signals;
  if (given.has("signals")) signals = platoon::signal_names(given["signals"]);
  std::optional<platoon::ProgressDisplay> display;
  const auto progress = [&](std::uint64_t done, std::uint64_t total) {
    if (given.has("csv")) return;
    if (!display) display.emplace(total, "bytes", 1.0, "bytes");
    display->update(done, platoon::now());
  };
  const platoon::BagSource bags{given.words, given.has("partial") ? platoon::Accept::cut : platoon::Accept::whole,
                                given.has("unverified")};
  platoon::BagStatistics statistics = platoon::statistics_of_bags(bags, progress, signals);
  if (display) display->finish();
  return statistics;
}

// Whether the bag provides the requested results; prints all problems to standard error.
bool is_usable(const platoon::BagStatistics& statistics, const platoon::CommandLine& given) {
  const std::string& file = given.words.front();
  const bool partial = given.has("partial");
  if (given.has("unverified")) std::cerr << file << ": read without its checksums: a changed bit may go unnoticed\n";
  for (const std::string& topic : statistics.foreign_topics) {
    std::cerr << platoon::printable(topic) << ": foreign topic: skipped\n";
  }
  for (const std::string& finding : statistics.findings) std::cerr << finding << "\n";
  const bool whole =
      statistics.findings.empty() &&
      (statistics.result.complete || statistics.configuration.run.averaging() == platoon::Averaging::over_time);
  if (!whole && !partial) {
    std::cerr << file << ": the recording is not complete; --partial uses its whole batches\n";
  }
  if (statistics.result.realizations > 0) return whole || partial;
  std::cerr << file << ": holds no whole batch: there are no statistics\n";
  return false;
}

}  // namespace

int bag_statistics_main(int argc, char** argv) {
  const platoon::CommandLine given = platoon::parse_command_line(
      argc, argv,
      {"bag_statistics BAG...: statistics of a recorded platoon (several bags: a split one)\n"
       "Example: bag_statistics /tmp/run.bag --output /tmp/recorded",
       {},
       {{"output", "folder for statistics.csv and summary.json; without it none"},
        {"signals", "signals beside the tracking errors, as in gap,speed; without it those of the recorded run"},
        {"csv", "print statistics.csv instead of the report"},
        {"partial",
         "use the whole batches of a recording that is not complete: not closed, or cut off; damage is rejected all the same"},
        {"unverified",
         "read bags without checksums, too, as rosbag record writes them: a changed bit may go unnoticed"}},
       true,
       {"csv", "partial", "unverified"}});
  try {
    // Keep freed memory for the next message: returning it to the system and allocating it again would cost page
    // faults.
    mallopt(M_TRIM_THRESHOLD, 1 << 27);
    mallopt(M_TOP_PAD, 1 << 24);
    mallopt(M_MMAP_THRESHOLD, 1 << 25);
    if (given.words.empty())
      throw platoon::ConfigurationError({"BAG: missing: must be a recording, or all parts of a split one"});
    platoon::BagStatistics statistics = read(given);
    if (!is_usable(statistics, given)) return 1;
    platoon::Configuration& configuration = statistics.configuration;
    configuration.run.hosting = platoon::Hosting::bag;
    configuration.run.output = given["output"];
    const platoon::Prediction prediction = platoon::predict(configuration);
    if (!configuration.run.output.empty()) {
      configuration.run.resume = false;
      configuration.run.launch_id.clear();
      const std::unique_ptr<platoon::FolderLock> lock = platoon::lock_output(configuration.run);
      platoon::starting_point(configuration);  // throws if the folder holds results
      platoon::write_results(configuration, prediction, statistics.result);
    }
    if (given.has("csv")) {
      std::cout << platoon::statistics_csv(configuration, prediction, statistics.result);
    } else {
      std::cout << platoon::report(configuration, prediction, statistics.result);
    }
    return 0;
  } catch (const std::exception& error) {
    std::cerr << argv[0] << ": " << platoon::printable(error.what()) << "\n";
    return 1;
  }
}
