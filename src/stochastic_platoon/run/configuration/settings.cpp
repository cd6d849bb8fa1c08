#include "stochastic_platoon/run/configuration/settings.hpp"

#include <cstddef>

namespace platoon {

namespace {

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
      {"followers", "20", "number of followers N, 1 or more", nullptr},
      {"steps", "",
       "steps per realization; 0: one endless realization with time averages; empty: 10 s of driving, from 100 to 10000 steps",
       nullptr},
      {"realizations", "10000", "number of realizations", nullptr},
      {"batch", "0", "realizations per message; 0: choose", nullptr},
      {"rate", "0", "steps per second of wall time; 0: as fast as possible", nullptr},
      {"seed", "1", "seed of the noise", nullptr},
      {"hosting", "processes", "processes: each vehicle its own node; one_process: all in one, no copies", nullptr},
      {"output", "", "folder for the results; empty: a new one under the ROS home", nullptr},
      {"resume", "false", "true: continue the run in the output folder", nullptr},
      {"record", "", "bag to record to, ends in .bag; empty: none", nullptr},
      {"record_split_mb", "0", "begin another bag beyond this size in MiB; 0: one bag", nullptr},
      {"record_compression", "none", "none or lz4", nullptr},
      {"window", "0", "steps that may be unacknowledged; 0: choose", nullptr},
      {"stall_timeout", "2.0", "seconds without progress before the leader repeats a batch; 0: never", nullptr},
      {"external", "", "external vehicles, which platoon.launch does not start, as in 3,7; empty: none", nullptr},
      {"signals", "",
       "signals beside the tracking errors, as in gap,speed: gap, speed, acceleration, jerk, input, relative_speed; empty: none",
       nullptr},
      {"burn_in", "",
       "steps left out of the time averages of an endless run (empty: until the start has decayed to 1e-6), or of amplification.csv (empty: none)",
       nullptr},
      {"launch_id", "", "names one launch; empty: a new one", nullptr},
      {"first_realization", "0", "realizations before it come from earlier launches (configure finds out)", nullptr},
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
