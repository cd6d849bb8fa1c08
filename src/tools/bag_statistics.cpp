// The results of a recorded run, directly from its bag and without a master: bit for bit the same statistics.csv and
// summary.json.

#include <malloc.h>

#include <boost/program_options.hpp>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>

#include "stochastic_platoon/ros/bags/bag_statistics.hpp"
#include "stochastic_platoon/run/configuration/version.hpp"
#include "stochastic_platoon/run/io/atomic_file.hpp"
#include "stochastic_platoon/run/io/printable.hpp"
#include "stochastic_platoon/run/io/progress_display.hpp"
#include "stochastic_platoon/run/results/result_files.hpp"
#include "stochastic_platoon/run/results/run_report.hpp"

namespace {

namespace options = boost::program_options;

struct Arguments {
  platoon::BagSource bags;
  std::string output;
  bool csv = false;
  bool partial = false;
  std::optional<std::vector<std::string>> signals = {};
};

Arguments parse(int argc, char** argv) {
  Arguments arguments;
  options::options_description description(
      "bag_statistics BAG...: statistics of a recorded platoon (several bags: a split one)");
  description.add_options()("help,h", "print this")                                         //
      ("version", "print the version")                                                      //
      ("bag", options::value(&arguments.bags.files), "bag files; may stand without --bag")  //
      ("output", options::value(&arguments.output),
       "folder for statistics.csv and summary.json; without it none")  //
      ("signals", options::value<std::string>(),
       "signals beside the tracking errors, as in gap,speed; without it those of the recorded run")  //
      ("csv", options::bool_switch(&arguments.csv), "print statistics.csv instead of the report")    //
      ("partial", options::bool_switch(&arguments.partial),
       "use the whole batches of a recording that is not complete: not closed, or cut off; damage is rejected all the same")  //
      ("unverified", options::bool_switch(&arguments.bags.unverified),
       "read bags without checksums, too, as rosbag record writes them: a changed bit may go unnoticed");
  options::positional_options_description positional;
  positional.add("bag", -1);
  options::variables_map values;
  options::store(options::command_line_parser(argc, argv).options(description).positional(positional).run(), values);
  options::notify(values);
  if (values.count("version") > 0) {
    std::cout << "stochastic_platoon " << platoon::kVersion << "\n";
    std::exit(0);
  }
  if (values.count("help") > 0 || arguments.bags.files.empty()) {
    (values.count("help") > 0 ? std::cout : std::cerr) << description;
    std::exit(values.count("help") > 0 ? 0 : 2);
  }
  if (values.count("signals") > 0) arguments.signals = platoon::signal_names(values["signals"].as<std::string>());
  if (arguments.partial) arguments.bags.accept = platoon::Accept::cut;
  return arguments;
}

platoon::BagStatistics read(const Arguments& arguments) {
  std::unique_ptr<platoon::ProgressDisplay> display;
  const auto progress = [&](std::uint64_t done, std::uint64_t total) {
    if (arguments.csv) return;
    if (!display) display = std::make_unique<platoon::ProgressDisplay>(total, "bytes", 1.0, "bytes");
    display->update(done, std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count());
  };
  platoon::BagStatistics statistics = platoon::statistics_of_bags(arguments.bags, progress, arguments.signals);
  if (display) display->finish();
  return statistics;
}

// Whether the bag provides the requested results; prints all problems to standard error.
bool is_usable(const platoon::BagStatistics& statistics, const Arguments& arguments) {
  if (arguments.bags.unverified)
    std::cerr << arguments.bags.files.front() << ": read without its checksums: a changed bit may go unnoticed\n";
  for (const std::string& topic : statistics.foreign_topics) {
    std::cerr << platoon::printable(topic) << ": foreign: passed over\n";
  }
  for (const std::string& finding : statistics.findings) std::cerr << finding << "\n";
  const bool whole =
      statistics.findings.empty() &&
      (statistics.result.complete || statistics.configuration.run.averaging() == platoon::Averaging::over_time);
  if (!whole && !arguments.partial) {
    std::cerr << arguments.bags.files.front() << ": the recording is not complete; --partial uses its whole batches\n";
  }
  if (statistics.result.realizations > 0) return whole || arguments.partial;
  std::cerr << arguments.bags.files.front() << ": holds no whole batch: there are no statistics\n";
  return false;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    // Keep freed memory for the next message: returning it to the system and allocating it again would cost page
    // faults.
    mallopt(M_TRIM_THRESHOLD, 1 << 27);
    mallopt(M_TOP_PAD, 1 << 24);
    mallopt(M_MMAP_THRESHOLD, 1 << 25);
    const Arguments arguments = parse(argc, argv);
    platoon::BagStatistics statistics = read(arguments);
    if (!is_usable(statistics, arguments)) return 1;
    platoon::Configuration& configuration = statistics.configuration;
    configuration.run.hosting = platoon::Hosting::bag;
    configuration.run.output = arguments.output;
    const platoon::Prediction prediction = platoon::predict(configuration);
    if (!arguments.output.empty()) {
      configuration.run.resume = false;
      configuration.run.launch_id.clear();
      const std::unique_ptr<platoon::FolderLock> lock = platoon::lock_output(configuration.run);
      platoon::starting_point(configuration);  // throws if the folder holds results
      platoon::write_results(configuration, prediction, statistics.result);
    }
    if (arguments.csv) {
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
