#include "stochastic_platoon/run/configuration/run_options.hpp"

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <charconv>
#include <cmath>
#include <set>
#include <sstream>
#include <stdexcept>

#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/run/io/printable.hpp"

namespace platoon {

namespace {
// Limit of the noise counter for realizations and steps.
constexpr std::int64_t kMaxCount = std::int64_t{1} << 46;

// Cells of the statistics: followers times steps. A run keeps about 200 bytes per cell.
constexpr std::int64_t kMaxCells = 20000000;

constexpr std::uint64_t kMaxPositions = std::uint64_t{1} << 63;

// The paper's example has a sample period of 0.1 s and 100 steps.
constexpr std::int64_t kFewestChosenSteps = 100;

// Whether a value is left empty, so that its default is chosen once the model is known.
bool is_left_empty(Section& section, const std::string& key) {
  return section.has(key) && section.text(key, "a whole number").empty();
}

// A rate or a time: 0, or at least `least`. ROS timers count nanoseconds in 64 bits, and seconds in 32.
double read_zero_or_more(Section& section, const std::string& key, double least) {
  const double value = section.number(key, {kNotNegative.text, 0.0, 1e6});
  if (value > 0.0 && value < least) section.reject(key, formatted("%g", value), formatted("0 or at least %g", least));
  return value;
}

std::vector<std::string> read_signals(Section& section) {
  const std::string text = section.text("signals");
  try {
    return signal_names(text);
  } catch (const std::invalid_argument&) {
    section.reject("signals", printable(shortened(text)),
                   "some of " + all_signal_names() + ", each once, separated by commas");
    return {};
  }
}

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
  RunOptions options;
  options.followers = static_cast<std::size_t>(section.integer("followers", 1, kMaxFollowers));
  options.steps_chosen = is_left_empty(section, "steps");
  options.steps = options.steps_chosen ? kFewestChosenSteps : section.integer("steps", 0, kMaxCount);
  options.realizations = static_cast<std::uint64_t>(section.integer("realizations", 1, kMaxCount));
  options.batch = static_cast<std::uint64_t>(section.integer("batch", 0, 1 << 24));
  options.rate = read_zero_or_more(section, "rate", 1e-6);
  options.seed = static_cast<std::uint64_t>(section.integer("seed", 0, INT64_MAX));
  options.hosting = section.choice("hosting", {"processes", "one_process"}) == "one_process" ? Hosting::one_process
                                                                                             : Hosting::processes;
  options.output = section.text("output");
  options.resume = section.boolean("resume");
  options.first_realization = static_cast<std::uint64_t>(section.integer("first_realization", 0, kMaxCount));
  options.record = section.text("record");
  options.record_split_mb = section.integer("record_split_mb", 0, 1 << 30);
  options.record_compression = section.choice("record_compression", {"none", "lz4"});
  options.launch_id = section.text("launch_id");
  options.number =
      section.has("run_number") ? static_cast<std::uint64_t>(section.integer("run_number", 1, kMaxCount)) : 1;
  options.window = section.integer("window", 0, 1 << 20);
  options.stall_timeout = read_zero_or_more(section, "stall_timeout", 1e-3);
  options.burn_in_chosen = section.has("burn_in_chosen") && section.boolean("burn_in_chosen");
  if (is_left_empty(section, "burn_in")) {
    options.burn_in_chosen = true;
    options.burn_in = 0;  // until the model is known
  } else {
    options.burn_in = section.integer("burn_in", 0, kMaxCount);
  }
  if (section.has("external")) options.external = read_external(section, options.followers);
  if (section.has("signals")) options.signals = read_signals(section);
  section.reject_unknown_keys();
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
  nlohmann::json document = {{"followers", options.followers},
                             {"steps", options.steps},
                             {"realizations", options.realizations},
                             {"batch", options.batch},
                             {"rate", options.rate},
                             {"seed", options.seed},
                             {"hosting", to_string(options.hosting)},
                             {"output", options.output},
                             {"resume", options.resume},
                             {"first_realization", options.first_realization},
                             {"record", options.record},
                             {"record_split_mb", options.record_split_mb},
                             {"record_compression", options.record_compression},
                             {"launch_id", options.launch_id},
                             {"window", options.window},
                             {"stall_timeout", options.stall_timeout},
                             {"burn_in", options.burn_in}};
  if (options.burn_in_chosen) document["burn_in_chosen"] = true;
  if (options.number > 1) document["run_number"] = options.number;
  // Absent without external vehicles, so that the text of other runs never changes.
  std::string external;
  for (const std::size_t vehicle : options.external)
    external += (external.empty() ? "" : ",") + std::to_string(vehicle);
  if (!external.empty()) document["external"] = external;
  if (!options.signals.empty()) document["signals"] = boost::algorithm::join(options.signals, ",");
  return document;
}

}  // namespace platoon
