// simulate FAULTS SEED: the nodes of the package in a simulated world (README.md) until that many faults have struck.
// Prints what depends on the two numbers alone; its last line counts the runs that were wrong or hung, and the status
// is 1 if there is one. Of the first of them it prints the shortest history that fails.

#include <ros/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "simulation/scenario.hpp"
#include "stochastic_platoon/run/io/digest.hpp"

namespace {

using platoon::simulation::Outcome;
using platoon::simulation::Plan;

constexpr std::size_t kShownLines = 60;

/// What a worker reports of a plan.
struct Report {
  std::uint64_t number, history;
  bool wrong, hung;
};

std::uint64_t seed_of(std::uint64_t seed, std::uint64_t number) {
  return platoon::digest(std::to_string(seed) + " " + std::to_string(number));
}

bool fails(const Outcome& outcome) {
  return outcome.hung || !outcome.wrong.empty();
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
    const Report report{number, digest_of(outcome.history), !outcome.wrong.empty() && !outcome.hung, outcome.hung};
    if (::write(output, &report, sizeof report) != sizeof report) std::_Exit(1);
  }
}

void print_history(std::FILE* output, const Plan& plan) {
  const Outcome outcome = carry_out(plan);
  for (const std::string& line : outcome.history) std::fprintf(output, "%s\n", line.c_str());
  std::fprintf(output, "%s\n", outcome.wrong.c_str());
}

void explain(std::FILE* output, std::uint64_t seed, std::uint64_t number) {
  const Plan plan = shortest(platoon::simulation::plan_of(seed_of(seed, number)));
  const Outcome outcome = carry_out(plan);
  std::fprintf(output, "\nrun %llu of seed %llu: %s\nfaults that suffice:\n", static_cast<unsigned long long>(number),
               static_cast<unsigned long long>(seed), outcome.wrong.c_str());
  for (const auto& fault : plan.faults)
    std::fprintf(output, "  after %.3f s: %s\n", fault.wait, to_string(fault).c_str());
  std::fprintf(output, "its history%s:\n", outcome.history.size() > kShownLines ? ", the end" : "");
  const std::size_t begin = outcome.history.size() - std::min(outcome.history.size(), kShownLines);
  for (std::size_t k = begin; k < outcome.history.size(); ++k)
    std::fprintf(output, "  %s\n", outcome.history[k].c_str());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3 && argc != 4) {
    std::fprintf(stderr, "usage: simulate FAULTS SEED [RUN, to print its history]\n");
    return 2;
  }
  const std::uint64_t faults = std::strtoull(argv[1], nullptr, 10), seed = std::strtoull(argv[2], nullptr, 10);
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
  };
  if (argc == 4) {
    within(0);
    print_history(output, platoon::simulation::plan_of(seed_of(seed, std::strtoull(argv[3], nullptr, 10))));
    std::filesystem::remove_all(folder);
    return 0;
  }

  int pipes[2];
  if (::pipe(pipes) != 0) return 2;
  const std::uint64_t workers = std::max(std::thread::hardware_concurrency(), 1u);
  std::vector<pid_t> children;
  for (std::uint64_t worker = 0; worker < workers; ++worker) {
    children.push_back(::fork());
    if (children.back() != 0) continue;
    ::close(pipes[0]);
    within(worker);
    work(seed, plans, worker, workers, pipes[1]);
    std::_Exit(0);
  }
  ::close(pipes[1]);
  std::vector<Report> reports;
  Report report{};
  while (::read(pipes[0], &report, sizeof report) == sizeof report) reports.push_back(report);
  bool ended = true;
  for (const pid_t child : children) {
    int status = 0;
    ::waitpid(child, &status, 0);
    ended = ended && status == 0;
  }
  std::sort(reports.begin(), reports.end(), [](const Report& a, const Report& b) { return a.number < b.number; });
  std::uint64_t wrong = 0, hung = 0;
  std::string histories;
  for (const Report& each : reports) {
    wrong += each.wrong ? 1 : 0;
    hung += each.hung ? 1 : 0;
    histories += std::to_string(each.history) + " ";
  }
  const auto failed =
      std::find_if(reports.begin(), reports.end(), [](const Report& each) { return each.wrong || each.hung; });
  if (failed != reports.end()) {
    within(workers);
    explain(output, seed, failed->number);
  }
  std::filesystem::remove_all(folder);
  if (!ended || reports.size() != plans)
    std::fprintf(output, "only %zu of %llu runs ended: a worker has died\n", reports.size(),
                 static_cast<unsigned long long>(plans));
  std::fprintf(output, "digest of the histories: %016llx\n",
               static_cast<unsigned long long>(platoon::digest(histories)));
  std::fprintf(output, "%llu faults in %llu runs: %llu wrong, %llu hung\n", static_cast<unsigned long long>(faults),
               static_cast<unsigned long long>(plans), static_cast<unsigned long long>(wrong),
               static_cast<unsigned long long>(hung));
  std::fflush(output);
  return wrong + hung > 0 || !ended || reports.size() != plans ? 1 : 0;
}
