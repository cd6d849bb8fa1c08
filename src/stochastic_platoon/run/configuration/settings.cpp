#include "stochastic_platoon/run/configuration/settings.hpp"

#include <boost/algorithm/string/join.hpp>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <utility>

#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/run/io/printable.hpp"

namespace platoon {

namespace {

// A member of RunOptions, and the function of a section and a key that reads it.
template <typename Value, typename Read>
RunValue member(Value RunOptions::*of, Read read) {
  return {[=](Section& section, const std::string& key, RunOptions& run) {
            run.*of = static_cast<Value>(read(section, key));
          },
          [of](const RunOptions& run) { return nlohmann::json(run.*of); }};
}

auto whole(std::int64_t least, std::int64_t most) {
  return [=](Section& section, const std::string& key) { return section.integer(key, least, most); };
}

// A rate or a time: 0, or at least `least`. ROS timers count nanoseconds in 64 bits, and seconds in 32.
auto none_or(double least) {
  return [=](Section& section, const std::string& key) {
    const double value = section.number(key, {kNotNegative.text, 0.0, 1e6});
    if (value > 0.0 && value < least) section.reject(key, formatted("%g", value), formatted("0 or at least %g", least));
    return value;
  };
}

const auto any_text = [](Section& section, const std::string& key) { return section.text(key); };

// Empty: a default that is chosen once the model is known.
RunValue chosen_number(std::int64_t RunOptions::*of, bool RunOptions::*chosen) {
  RunValue value = member(of, whole(0, kMaxCount));
  value.read = [given = value.read, chosen](Section& section, const std::string& key, RunOptions& run) {
    const bool is_empty = section.has(key) && section.text(key, "a whole number").empty();
    if (is_empty) run.*chosen = true;
    if (!is_empty) given(section, key, run);
  };
  return value;
}

nlohmann::json if_any(const std::string& text) {
  return text.empty() ? nlohmann::json() : nlohmann::json(text);
}

std::string external_text(const RunOptions& run) {
  std::string text;
  for (const std::size_t vehicle : run.external) text += (text.empty() ? "" : ",") + std::to_string(vehicle);
  return text;
}

void read_signals(Section& section, const std::string& key, RunOptions& run) {
  if (!section.has(key)) return;
  const std::string text = section.text(key);
  try {
    run.signals = signal_names(text);
  } catch (const std::invalid_argument&) {
    section.reject(key, printable(shortened(text)),
                   "some of " + all_signal_names() + ", each once, separated by commas");
  }
}

Setting of_run(const char* name, const char* default_value, const char* help, RunValue value) {
  return {name, default_value, help, nullptr, {}, std::move(value)};
}

// The model file keys that a setting or a key sets or removes.
std::vector<std::string> keys_of(const std::string& name) {
  for (const Setting& setting : settings()) {
    if (setting.model_key == nullptr || (name != setting.name && name != setting.model_key)) continue;
    std::vector<std::string> keys{setting.model_key};
    keys.insert(keys.end(), setting.replaces.begin(), setting.replaces.end());
    return keys;
  }
  return {name};
}

// What the later of two names does to a key of the earlier one; null: nothing.
const char* effect(const std::string& earlier, const std::string& later) {
  for (const std::string& first : keys_of(earlier)) {
    for (const std::string& second : keys_of(later)) {
      if (first == second) return ", which sets it too";
      if (first.compare(0, second.size() + 1, second + "/") == 0) return ", which it replaces";
    }
  }
  return nullptr;
}

}  // namespace

const std::vector<Setting>& settings() {
  static const std::vector<Setting> all = {
      {"headway",
       "",
       "time headway h in sample periods, above 0; empty: the model file's",
       "time_headway",
       {"time_headway_seconds"}},
      {"headway_seconds",
       "",
       "time headway h in seconds, in place of headway",
       "time_headway_seconds",
       {"time_headway"}},
      {"noise_variance", "", "channel noise variance P_d [m^2], 0 or more; empty: the model file's", "noise_variance"},
      {"loss",
       "",
       "loss probability of the link (of the radio, if there is one), from 0 to below 1; empty: the model file's",
       "channel/loss/probability",
       {"channel/loss/trace", "channel/loss/column", "channel/loss/runs", "channel/loss/by_distance",
        "channel/loss/markov"}},
      {"mean_burst", "", "mean number of losses in a row on the same link, 1 or more; empty: the model file's",
       "channel/loss/mean_burst"},
      {"delay", "", "delay of the link in whole steps, 0 or more; empty: the model file's", "channel/delay"},
      {"leader",
       "",
       "recorded drive as the leader: CSV with columns time [s] and speed [m/s], or a shipped one as city.csv; empty: the model file's",
       "leader/file",
       {"leader"}},
      of_run("followers", "20", "number of followers N, 1 or more",
             {[](Section& section, const std::string& key, RunOptions& run) {
                const std::size_t before = section.problems();
                const std::int64_t given = section.integer(key, 1, kMaxFollowers);
                // A number that is not allowed limits no other value.
                run.followers = static_cast<std::size_t>(section.problems() > before ? kMaxFollowers : given);
              },
              [](const RunOptions& run) { return nlohmann::json(run.followers); }}),
      of_run(
          "steps", "",
          "steps per realization; 0: one endless realization with time averages; empty: 10 s of driving, from 100 to 10000 steps",
          chosen_number(&RunOptions::steps, &RunOptions::steps_chosen)),
      of_run("realizations", "10000", "number of realizations", member(&RunOptions::realizations, whole(1, kMaxCount))),
      of_run("batch", "0", "realizations per message; 0: choose", member(&RunOptions::batch, whole(0, 1 << 24))),
      of_run("rate", "0", "steps per second of wall time; 0: as fast as possible",
             member(&RunOptions::rate, none_or(1e-6))),
      of_run("seed", "1", "seed of the noise",
             member(&RunOptions::seed, whole(0, std::numeric_limits<std::int64_t>::max()))),
      of_run("hosting", "processes", "processes: each vehicle its own node; one_process: all in one, no copies",
             {[](Section& section, const std::string& key, RunOptions& run) {
                const bool one = section.choice(key, {"processes", "one_process"}) == "one_process";
                run.hosting = one ? Hosting::one_process : Hosting::processes;
              },
              [](const RunOptions& run) { return nlohmann::json(to_string(run.hosting)); }}),
      of_run("output", "", "folder for the results; empty: a new one under the ROS home",
             member(&RunOptions::output, any_text)),
      of_run("resume", "false", "true: continue the run in the output folder",
             member(&RunOptions::resume, std::mem_fn(&Section::boolean))),
      of_run("record", "", "bag to record to, ends in .bag; empty: none", member(&RunOptions::record, any_text)),
      of_run("record_split_mb", "0", "begin another bag beyond this size in MiB; 0: one bag",
             member(&RunOptions::record_split_mb, whole(0, 1 << 30))),
      of_run("record_compression", "none", "none or lz4",
             member(&RunOptions::record_compression,
                    [](Section& section, const std::string& key) {
                      return section.choice(key, {"none", "lz4"});
                    })),
      of_run("window", "0", "steps that may be unacknowledged; 0: choose",
             member(&RunOptions::window, whole(0, 1 << 20))),
      of_run("stall_timeout", "2.0", "seconds without progress before the leader repeats a batch; 0: never",
             member(&RunOptions::stall_timeout, none_or(1e-3))),
      of_run("external", "", "external vehicles, which platoon.launch does not start, as in 3,7; empty: none",
             {[](Section& section, const std::string& key, RunOptions& run) {
                if (section.has(key)) run.external = read_external(section, run.followers);
              },
              [](const RunOptions& run) { return if_any(external_text(run)); }}),
      of_run(
          "signals", "",
          "signals beside the tracking errors, as in gap,speed: gap, speed, acceleration, jerk, input, relative_speed; empty: none",
          {read_signals, [](const RunOptions& run) { return if_any(boost::algorithm::join(run.signals, ",")); }}),
      of_run(
          "burn_in", "",
          "steps left out of the time averages of an endless run (empty: until the start has decayed to 1e-6), or of amplification.csv (empty: none)",
          chosen_number(&RunOptions::burn_in, &RunOptions::burn_in_chosen)),
      of_run("launch_id", "", "names one launch; empty: a new one", member(&RunOptions::launch_id, any_text)),
      of_run("first_realization", "0", "realizations before it come from earlier launches (configure finds out)",
             member(&RunOptions::first_realization, whole(0, kMaxCount))),
  };
  return all;
}

std::vector<std::string> conflicts(const std::vector<std::string>& names) {
  std::vector<std::string> problems;
  for (std::size_t later = 1; later < names.size(); ++later) {
    for (std::size_t earlier = 0; earlier < later; ++earlier) {
      const char* dropped = effect(names[earlier], names[later]);
      if (dropped == nullptr) continue;
      problems.push_back(names[later] + ": given: must be absent beside " + names[earlier] + dropped);
      break;
    }
  }
  return problems;
}

void add_monte_carlo_batch(std::map<std::string, std::string>& given) {
  const auto signals = given.find("signals");
  const bool with_signals = signals != given.end() && !signals->second.empty();
  given.emplace("batch", with_signals ? kMonteCarloBatchWithSignals : kMonteCarloBatch);
}

}  // namespace platoon
