#include "simulation/launches.hpp"

#include <iterator>

#include "stochastic_platoon/ros/bags/bag_statistics.hpp"
#include "stochastic_platoon/run/configuration/configuration_document.hpp"
#include "stochastic_platoon/run/io/read_file.hpp"
#include "stochastic_platoon/run/report/prediction.hpp"
#include "stochastic_platoon/run/results/checkpoint.hpp"
#include "stochastic_platoon/run/results/result_files.hpp"
#include "stochastic_platoon/run/scaling/whole_run.hpp"

namespace platoon::simulation {

namespace {

std::size_t any(std::mt19937_64& random, std::size_t from, std::size_t to) {
  return from + random() % (to - from + 1);
}

}  // namespace

std::map<std::string, std::string> random_settings(std::mt19937_64& random) {
  static const char* const models[] = {"paper.yaml",
                                       "cacc.yaml",
                                       "lossy.yaml",
                                       "mixed.yaml",
                                       "paper.yaml",
                                       "by_distance.yaml",
                                       "acc_limits.yaml",
                                       "two_ahead.yaml",
                                       "cacc.yaml",
                                       "path_cacc.yaml",
                                       "leader_and_predecessor.yaml"};
  std::map<std::string, std::string> settings;
  settings["model"] = std::string(PLATOON_SOURCE_DIR "/config/") + models[any(random, 0, std::size(models) - 1)];
  const std::size_t followers = any(random, 1, 4);
  settings["followers"] = std::to_string(followers);
  settings["steps"] = std::to_string(any(random, 2, 12));
  settings["realizations"] = std::to_string(any(random, 1, 24));
  settings["batch"] = std::to_string(any(random, 1, 5));
  settings["seed"] = std::to_string(any(random, 1, 3));
  settings["window"] = std::to_string(any(random, 2, 40));
  settings["stall_timeout"] = any(random, 0, 3) == 0 ? "0.5" : "2";
  if (any(random, 0, 4) == 0) settings["rate"] = "200";
  if (any(random, 0, 2) == 0) settings["signals"] = "gap,speed";
  if (any(random, 0, 2) == 0) settings["record"] = "yes";
  if (any(random, 0, 3) == 0) settings["external"] = std::to_string(any(random, 1, followers));
  return settings;
}

Configuration launched(const std::map<std::string, std::string>& settings) {
  Configuration configuration = parse_configuration(configuration_document(settings));
  const std::unique_ptr<FolderLock> lock = lock_output(configuration.run);
  if (const std::optional<Checkpoint> start = starting_point(configuration))
    configuration.run.first_realization = start->totals.count();
  return configuration;
}

const std::string& reference(const Configuration& configuration) {
  static std::map<std::string, std::string> known;
  Configuration plain = configuration;
  plain.run.output.clear();
  plain.run.record.clear();
  plain.run.launch_id.clear();
  plain.run.first_realization = 0;
  plain.run.resume = false;
  const std::string key = to_json(plain).dump();
  const auto found = known.find(key);
  if (found != known.end()) return found->second;
  Configuration computed = plain;
  computed.run.external.clear();
  computed.run.hosting = Hosting::monte_carlo;
  const WholeRun run = compute_run(computed, {});
  return known[key] = statistics_csv(plain, predict(plain), run.result);
}

std::string problem_of(const Configuration& configuration, bool recorded) {
  const RunOptions& run = configuration.run;
  const std::string& wanted = reference(configuration);
  if (read_file(run.output + "/statistics.csv", kMostWrittenBytes) != wanted)
    return run.output + "/statistics.csv is not that of monte_carlo";
  if (!recorded) return "";
  try {
    const BagStatistics found = statistics_of_bags({{run.record}}, [](std::uint64_t, std::uint64_t) {});
    if (!found.findings.empty()) return run.record + ": " + found.findings.front();
    if (!found.result.complete) return run.record + ": is not complete";
    if (statistics_csv(configuration, predict(configuration), found.result) != wanted)
      return run.record + " does not replay to the statistics of monte_carlo";
  } catch (const BagError& error) {
    return error.what();
  }
  return "";
}

}  // namespace platoon::simulation
