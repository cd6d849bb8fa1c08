// Judges the results of runs: status 0 if every run is complete, undamaged and in agreement with its theory.

#include <chrono>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <limits>
#include <optional>
#include <thread>

#include "stochastic_platoon/run/configuration/configuration_error.hpp"
#include "stochastic_platoon/run/configuration/single_number.hpp"
#include "stochastic_platoon/run/io/process_identity.hpp"
#include "stochastic_platoon/run/results/result_check.hpp"
#include "tools/command_line.hpp"

namespace {

// One line if the run passes, or one per problem.
std::string lines_of(const std::string& folder, bool* passes) {
  platoon::ResultCheck check;
  try {
    check = platoon::check_results(folder);
  } catch (const std::exception& error) {
    check.problems.emplace_back(error.what());
  }
  *passes = check.problems.empty();
  std::string text = check.problems.empty() ? folder + ": " + check.passed + "\n" : "";
  for (const std::string& problem : check.problems) text += folder + ": " + problem + "\n";
  return text;
}

// Checks the run before the process ends, and again if its results have changed by then, so that the lines follow the
// end at once.
std::string lines_after(const std::string& process, const std::string& folder, bool* passes) {
  const std::int64_t number = platoon::integer_of("after", process, 1, std::numeric_limits<std::int32_t>::max());
  std::signal(SIGINT, SIG_IGN);  // Ctrl-C ends that process
  const auto written = [&folder] {
    std::error_code none_yet;
    return std::filesystem::last_write_time(folder + "/summary.json", none_yet);
  };
  const auto before = written();
  const std::optional<platoon::ProcessIdentity> launch = platoon::process_identity(static_cast<pid_t>(number));
  std::string text = lines_of(folder, passes);
  while (launch && platoon::lives(*launch)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  return written() == before ? text : lines_of(folder, passes);
}

}  // namespace

int check_main(int argc, char** argv) {
  const platoon::CommandLine given = platoon::parse_command_line(
      argc, argv,
      {"check RUN...: whether the runs in these folders are complete, undamaged and in agreement with their theory.\n"
       "Status 0 if all are; otherwise 1 and the reasons, one per line\n"
       "Example: check /tmp/platoon",
       {},
       {{"after", "number of a process: prints when it has ended"}},
       true});
  try {
    if (given.words.empty()) throw platoon::ConfigurationError({"RUN: missing: must be the folder of a run"});
    bool all = true;
    for (const std::string& folder : given.words) {
      bool passes = false;
      std::cout << (given.has("after") ? lines_after(given["after"], folder, &passes) : lines_of(folder, &passes))
                << std::flush;
      all = all && passes;
    }
    return all ? 0 : 1;
  } catch (const std::exception& error) {
    std::cerr << argv[0] << ": " << error.what() << "\n";
    return 1;
  }
}
