#include "stochastic_platoon/run/configuration/run_options.hpp"

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <charconv>
#include <cmath>
#include <set>
#include <sstream>

#include "stochastic_platoon/run/configuration/settings.hpp"
#include "stochastic_platoon/run/io/printable.hpp"

namespace platoon {

namespace {
// Cells of the statistics: followers times steps. A run keeps about 200 bytes per cell.
constexpr std::int64_t kMaxCells = 20000000;

constexpr std::uint64_t kMaxPositions = std::uint64_t{1} << 63;

// The paper's example has a sample period of 0.1 s and 100 steps.
constexpr std::int64_t kFewestChosenSteps = 100;

}  // namespace

// Each number must have one spelling, because the launch files compare the entries of the list as text.
std::vector<std::size_t> read_external(Section& section, std::size_t followers) {
  const std::string text = section.text("external");
  std::set<std::size_t> external;
  if (text == "none") return {};
  std::istringstream words(text);
  for (std::string word; std::getline(words, word, ',');) {
    std::size_t vehicle = 0;
    const auto read = std::from_chars(word.data(), word.data() + word.size(), vehicle);
    const bool is_one = read.ec == std::errc() && std::to_string(vehicle) == word && vehicle >= 1 &&
                        vehicle <= followers && external.insert(vehicle).second;
    if (is_one && (text.empty() || text.back() != ',')) continue;
    section.reject("external", printable(shortened(text)),
                   "numbers of followers from 1 to " + std::to_string(followers) +
                       ", each once, separated by commas, as in 3,7, or none");
    return {};
  }
  return {external.begin(), external.end()};
}

const char* to_string(Hosting hosting) {
  static constexpr const char* kNames[] = {"processes", "one_process", "monte_carlo", "bag"};
  return kNames[static_cast<std::size_t>(hosting)];
}

std::int64_t chosen_steps(const RunOptions& options, double sample_period, double seconds) {
  const auto followers = static_cast<double>(options.followers),
             realizations = static_cast<double>(options.realizations),
             kinds = static_cast<double>(1 + options.signals.size());
  const double most = std::min({1e4, static_cast<double>(kMaxCells) / followers / kinds,
                                static_cast<double>(kMaxPositions) / 2.0 / realizations / (followers + 1.0)});
  const double steps = std::min(std::round(seconds / sample_period), most);
  return std::max(kFewestChosenSteps, static_cast<std::int64_t>(steps));
}

std::uint64_t chosen_batch(const RunOptions& options) {
  const bool recorded = !options.record.empty();
  const std::uint64_t positions_of_a_step = std::uint64_t{1} << (recorded ? 21 : 22);
  const std::uint64_t streams = recorded ? 2 * options.followers + 1 : options.followers;
  std::uint64_t batch = recorded ? 32768 : 8192;
  while (batch > 64 && batch * streams > positions_of_a_step) batch /= 2;
  return std::min(batch, options.realizations);
}

std::int64_t chosen_window(std::uint64_t batch, std::size_t followers) {
  const std::uint64_t positions_in_flight = std::uint64_t{5} << 19;  // 20 MiB
  const std::uint64_t per_step = std::max<std::uint64_t>(batch * followers, 1);
  return static_cast<std::int64_t>(std::clamp<std::uint64_t>(positions_in_flight / per_step, 4, 256));
}

RunOptions read_run_options(Section section) {
  RunOptions options{};
  const std::size_t before = section.problems();
  if (section.has("burn_in_chosen")) options.burn_in_chosen = section.boolean("burn_in_chosen");
  options.number =
      section.has("run_number") ? static_cast<std::uint64_t>(section.integer("run_number", 1, kMaxCount)) : 1;
  for (const Setting& setting : settings()) {
    if (setting.of_run.read) setting.of_run.read(section, setting.name, options);
  }
  if (options.steps_chosen) options.steps = kFewestChosenSteps;
  const bool is_valid = section.problems() == before;
  section.reject_unknown_keys();
  if (!is_valid) return options;  // harmless defaults, which would be judged below
  if (options.steps == 0 && !options.signals.empty())
    section.reject("signals", boost::algorithm::join(options.signals, ","), "empty for averages over time (steps: 0)");
  const auto followers = static_cast<std::int64_t>(options.followers);
  const auto kinds = static_cast<std::int64_t>(1 + options.signals.size());
  if (options.steps > kMaxCells / followers / kinds) {
    section.reject(kinds > 1 ? "steps x followers x (1 + signals)" : "steps x followers",
                   std::to_string(options.steps) + " x " + std::to_string(followers) +
                       (kinds > 1 ? " x " + std::to_string(kinds) : ""),
                   "at most " + std::to_string(kMaxCells) +
                       ", as statistics are kept for each (steps: 0 averages over time instead)");
  } else if (options.realizations > kMaxPositions / static_cast<std::uint64_t>((options.steps + 1) * (followers + 1))) {
    section.reject("realizations x steps x followers",
                   std::to_string(options.realizations) + " x " + std::to_string(options.steps) + " x " +
                       std::to_string(followers),
                   "below 2^63, the limit of the counter");
  }
  if (options.steps == 0) options.realizations = 1;
  if (options.batch == 0) options.batch = chosen_batch(options);
  options.batch = std::min(options.batch, options.realizations);
  if (options.window == 0) options.window = chosen_window(options.batch, options.followers);
  return options;
}

bool RunOptions::has_amplification() const {
  return std::find(signals.begin(), signals.end(), "speed") != signals.end() && burn_in + 2 <= steps;
}

std::vector<std::string> RunOptions::receivers() const {
  std::vector<std::string> names{"monitor"};
  if (!record.empty()) names.emplace_back("recorder");
  return names;
}

bool RunOptions::is_external(std::size_t follower) const {
  return std::binary_search(external.begin(), external.end(), follower);
}

// In one process a message is consumed at once, and the further a vehicle is ahead, the longer its state stays in the
// cache. This does not hold if the others wait for an external vehicle.
std::size_t RunOptions::pipeline_depth() const {
  constexpr std::size_t kOfProcesses = 128;
  return hosting == Hosting::processes || !external.empty() ? kOfProcesses : followers;
}

nlohmann::json to_json(const RunOptions& options) {
  nlohmann::json document = nlohmann::json::object();
  for (const Setting& setting : settings()) {
    if (!setting.of_run.write) continue;
    const nlohmann::json value = setting.of_run.write(options);
    if (!value.is_null()) document[setting.name] = value;
  }
  if (options.burn_in_chosen) document["burn_in_chosen"] = true;
  if (options.number > 1) document["run_number"] = options.number;
  return document;
}

}  // namespace platoon
