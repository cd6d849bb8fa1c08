// simulate FAULTS SEED: the nodes of the package in a simulated world (README.md) until that many faults have struck.
// Prints what depends on the two numbers alone; its last line counts the runs that were wrong or hung, and the status
// is 1 if there is one. Of the first of them it prints the shortest history that fails.

#include <ros/time.h>
#include <rosbag/bag.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "simulation/scenario.hpp"
#include "stochastic_platoon/run/configuration/configuration_error.hpp"
#include "stochastic_platoon/run/configuration/single_number.hpp"
#include "stochastic_platoon/run/io/digest.hpp"

namespace {

using platoon::simulation::Outcome;
using platoon::simulation::Plan;

constexpr std::size_t kShownLines = 60;

/// What a worker reports of a plan.
struct Report {
  std::uint64_t number, history;
  bool failed, hung;
};

std::uint64_t seed_of(std::uint64_t seed, std::uint64_t number) {
  return platoon::digest(std::to_string(seed) + " " + std::to_string(number));
}

bool fails(const Outcome& outcome) {
  return !outcome.wrong.empty();
}

std::uint64_t digest_of(const std::vector<std::string>& history) {
  std::string text;
  for (const std::string& line : history) text += line + "\n";
  return platoon::digest(text);
}

/// Removes faults while the plan still fails: halves, quarters, single ones.
Plan shortest(Plan plan) {
  for (std::size_t span = std::max<std::size_t>(plan.faults.size() / 2, 1);; span /= 2) {
    for (std::size_t begin = 0; begin < plan.faults.size();) {
      Plan shorter = plan;
      const auto from = shorter.faults.begin() + static_cast<std::ptrdiff_t>(begin);
      shorter.faults.erase(from, from + static_cast<std::ptrdiff_t>(std::min(span, shorter.faults.size() - begin)));
      if (fails(carry_out(shorter)))
        plan = shorter;
      else
        begin += span;
    }
    if (span <= 1) return plan;
  }
}

void work(std::uint64_t seed, std::uint64_t plans, std::uint64_t worker, std::uint64_t workers, int output) {
  for (std::uint64_t number = worker; number < plans; number += workers) {
    const Outcome outcome = carry_out(platoon::simulation::plan_of(seed_of(seed, number)));
    const Report report{number, digest_of(outcome.history), fails(outcome), outcome.hung};
    if (::write(output, &report, sizeof report) != sizeof report) std::_Exit(1);
  }
}

/// Prints at most this many lines, the latest.
void print_history(std::FILE* output, const Outcome& outcome, std::size_t most, const char* indent) {
  const std::vector<std::string>& lines = outcome.history;
  for (std::size_t k = lines.size() - std::min(lines.size(), most); k < lines.size(); ++k)
    std::fprintf(output, "%s%s\n", indent, lines[k].c_str());
}

void explain(std::FILE* output, std::uint64_t seed, std::uint64_t number) {
  const Plan plan = shortest(platoon::simulation::plan_of(seed_of(seed, number)));
  const Outcome outcome = carry_out(plan);
  std::fprintf(output, "\nrun %llu of seed %llu: %s\nfaults that suffice:\n", static_cast<unsigned long long>(number),
               static_cast<unsigned long long>(seed), outcome.wrong.c_str());
  for (const auto& fault : plan.faults)
    std::fprintf(output, "  after %.3f s: %s\n", fault.wait, to_string(fault).c_str());
  std::fprintf(output, "its history%s:\n", outcome.history.size() > kShownLines ? ", the end" : "");
  print_history(output, outcome, kShownLines, "  ");
}

/// The reports of all plans, by processes that share them; fewer if one has died.
std::vector<Report> simulated(std::uint64_t seed, std::uint64_t plans,
                              const std::function<void(std::uint64_t worker)>& enter) {
  int pipes[2];
  if (::pipe(pipes) != 0) return {};
  const std::uint64_t workers = std::max(std::thread::hardware_concurrency(), 1u);
  std::vector<pid_t> children;
  for (std::uint64_t worker = 0; worker < workers; ++worker) {
    children.push_back(::fork());
    if (children.back() != 0) continue;
    ::close(pipes[0]);
    enter(worker);
    work(seed, plans, worker, workers, pipes[1]);
    std::_Exit(0);
  }
  ::close(pipes[1]);
  std::vector<Report> reports;
  Report report{};
  while (::read(pipes[0], &report, sizeof report) == sizeof report) reports.push_back(report);
  for (const pid_t child : children) ::waitpid(child, nullptr, 0);
  std::sort(reports.begin(), reports.end(), [](const Report& a, const Report& b) { return a.number < b.number; });
  return reports;
}

/// FAULTS, SEED and RUN, which is not given without an argument. Throws ConfigurationError.
std::array<std::uint64_t, 3> numbers_of(int argc, char** argv) {
  if (argc != 3 && argc != 4)
    throw platoon::ConfigurationError({"usage: simulate FAULTS SEED [RUN, to print its history]"});
  const std::pair<const char*, std::int64_t> names[] = {{"FAULTS", 1}, {"SEED", 0}, {"RUN", 0}};
  std::array<std::uint64_t, 3> numbers{};
  platoon::ProblemCollector problems;
  for (int n = 0; n + 1 < argc; ++n) {
    const auto& [name, least] = names[n];
    const auto number = problems.result_of([&, key = name, from = least] {
      return platoon::integer_of(key, argv[n + 1], from, std::numeric_limits<std::int64_t>::max());
    });
    numbers[static_cast<std::size_t>(n)] = static_cast<std::uint64_t>(number.value_or(0));
  }
  problems.require_none();
  return numbers;
}

}  // namespace

int main(int argc, char** argv) {
  std::array<std::uint64_t, 3> numbers{};
  try {
    numbers = numbers_of(argc, argv);
  } catch (const platoon::ConfigurationError& error) {
    std::fprintf(stderr, "simulate: %s\n", error.what());
    return 2;
  }
  const auto [faults, seed, run] = numbers;
  std::uint64_t plans = 0;
  for (std::uint64_t struck = 0; struck < faults; ++plans)
    struck += platoon::simulation::plan_of(seed_of(seed, plans)).faults.size();

  std::FILE* const output = ::fdopen(::dup(1), "w");
  if (std::freopen("/dev/null", "w", stdout) == nullptr) return 2;  // the nodes print their reports there
  ros::Time::init();
  char folder[] = "/dev/shm/platoon_simulation_XXXXXX";
  if (::mkdtemp(folder) == nullptr) return 2;
  const auto within = [&folder](std::uint64_t worker) {
    const std::string own = std::string(folder) + "/" + std::to_string(worker);
    std::filesystem::create_directory(own);
    std::filesystem::current_path(own);
    // Each bag loads the library of its plugins; while one is open, it stays loaded.
    static rosbag::Bag open(own + "/open.bag", rosbag::bagmode::Write);
  };
  if (argc == 4) {
    within(0);
    const Outcome outcome = carry_out(platoon::simulation::plan_of(seed_of(seed, run)));
    print_history(output, outcome, outcome.history.size(), "");
    std::fprintf(output, "%s\n", outcome.wrong.c_str());
    std::filesystem::remove_all(folder);
    return 0;
  }

  const std::vector<Report> reports = simulated(seed, plans, within);
  std::uint64_t failed = 0, hung = 0;
  std::string histories;
  for (const Report& each : reports) {
    failed += each.failed ? 1 : 0;
    hung += each.hung ? 1 : 0;
    histories += std::to_string(each.history) + " ";
  }
  const auto first = std::find_if(reports.begin(), reports.end(), [](const Report& each) { return each.failed; });
  if (first != reports.end()) {
    within(0);
    explain(output, seed, first->number);
  }
  std::filesystem::remove_all(folder);
  if (reports.size() != plans)
    std::fprintf(output, "only %zu of %llu runs ended: a worker has died\n", reports.size(),
                 static_cast<unsigned long long>(plans));
  std::fprintf(output, "digest of the histories: %016llx\n",
               static_cast<unsigned long long>(platoon::digest(histories)));
  std::fprintf(output, "%llu faults in %llu runs: %llu wrong, %llu hung\n", static_cast<unsigned long long>(faults),
               static_cast<unsigned long long>(plans), static_cast<unsigned long long>(failed - hung),
               static_cast<unsigned long long>(hung));
  std::fflush(output);
  return failed > 0 || reports.size() != plans ? 1 : 0;
}
