#include "stochastic_platoon/configuration/run_options.hpp"

#include <algorithm>

namespace platoon {

namespace {
constexpr std::int64_t kMaxFollowers = 100000;
constexpr std::int64_t kMaxCount = std::int64_t{1}
                                   << 46;  // of realizations and steps: what the noise's counter can name
}  // namespace

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
  options.steps = section.integer("steps", 0, kMaxCount);
  options.realizations = static_cast<std::uint64_t>(section.integer("realizations", 1, kMaxCount));
  options.batch = static_cast<std::uint64_t>(section.integer("batch", 0, 1 << 24));
  options.rate = section.number("rate", kNotNegative);
  options.seed = static_cast<std::uint64_t>(section.integer("seed", 0, INT64_MAX));
  options.hosting = section.choice("hosting", {"processes", "one_process"});
  options.output = section.text("output");
  options.resume = section.boolean("resume");
  options.first_realization = static_cast<std::uint64_t>(section.integer("first_realization", 0, kMaxCount));
  options.record = section.text("record");
  options.record_split_mb = section.integer("record_split_mb", 0, 1 << 30);
  options.record_compression = section.choice("record_compression", {"none", "lz4"});
  options.leader_bags = section.text("leader_bags");
  options.launch = section.text("launch");
  options.window = section.integer("window", 0, 1 << 20);
  options.stall_timeout = section.number("stall_timeout", kPositive);
  options.burn_in = section.integer("burn_in", 0, kMaxCount);
  section.reject_unknown_keys();
  if (options.steps == 0) options.realizations = 1;
  if (options.batch == 0) options.batch = chosen_batch(options);
  options.batch = std::min(options.batch, options.realizations);
  if (options.window == 0) options.window = chosen_window(options.batch, options.followers);
  return options;
}

std::vector<std::string> RunOptions::receivers() const {
  std::vector<std::string> names{"monitor"};
  if (!record.empty()) names.emplace_back("recorder");
  return names;
}

nlohmann::json to_json(const RunOptions& options) {
  return {{"followers", options.followers},
          {"steps", std::to_string(options.steps)},
          {"realizations", std::to_string(options.realizations)},
          {"batch", options.batch},
          {"rate", options.rate},
          {"seed", std::to_string(options.seed)},
          {"hosting", options.hosting},
          {"output", options.output},
          {"resume", options.resume},
          {"first_realization", std::to_string(options.first_realization)},
          {"record", options.record},
          {"record_split_mb", options.record_split_mb},
          {"record_compression", options.record_compression},
          {"leader_bags", options.leader_bags},
          {"launch", options.launch},
          {"window", options.window},
          {"stall_timeout", options.stall_timeout},
          {"burn_in", std::to_string(options.burn_in)}};
}

}  // namespace platoon
