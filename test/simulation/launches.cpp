#include "simulation/launches.hpp"

#include <algorithm>
#include <filesystem>
#include <iterator>

#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/math/simulation/trajectory.hpp"
#include "stochastic_platoon/ros/bags/bag_statistics.hpp"
#include "stochastic_platoon/ros/bags/bag_stream.hpp"
#include "stochastic_platoon/ros/bags/bag_writer.hpp"
#include "stochastic_platoon/ros/messages/position.hpp"
#include "stochastic_platoon/run/configuration/configuration_document.hpp"
#include "stochastic_platoon/run/io/read_file.hpp"
#include "stochastic_platoon/run/report/prediction.hpp"
#include "stochastic_platoon/run/results/checkpoint.hpp"
#include "stochastic_platoon/run/results/result_files.hpp"
#include "stochastic_platoon/run/scaling/whole_run.hpp"

namespace platoon::simulation {

using stochastic_platoon::Position;

namespace {

std::size_t any(std::mt19937_64& random, std::size_t from, std::size_t to) {
  return from + random() % (to - from + 1);
}

void make_endless(std::mt19937_64& random, std::map<std::string, std::string>& settings) {
  settings.erase("signals");
  settings["steps"] = "0";
  settings["realizations"] = settings["batch"] = "1";
  settings["rate"] = std::to_string(any(random, 10, 100));
  settings["burn_in"] = std::to_string(any(random, 0, kEndlessSteps / 2));
}

}  // namespace

std::map<std::string, std::string> random_settings(std::mt19937_64& random, bool endless, const std::string& name) {
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
  if (any(random, 0, 5) == 0) settings["delay"] = std::to_string(any(random, 0, 6));
  if (any(random, 0, 5) == 0) settings["loss"] = "0.15";
  if (settings.count("loss") > 0 && any(random, 0, 1) == 0) settings["mean_burst"] = "2.5";
  if (any(random, 0, 2) == 0) settings["signals"] = "gap,speed";
  if (any(random, 0, 2) == 0) settings["record"] = name + ".bag";
  if (any(random, 0, 2) == 0) settings["record_compression"] = "lz4";
  if (!endless && any(random, 0, 9) == 0) {  // enough for a recording in parts
    settings["realizations"] = std::to_string(any(random, 1000, 5000));
    settings["batch"] = std::to_string(any(random, 200, 600));
    settings["record_split_mb"] = "1";
  }
  if (any(random, 0, 3) == 0) settings["external"] = std::to_string(any(random, 1, followers));
  settings["output"] = name;
  if (endless) make_endless(random, settings);
  if (random() % 4 == 0) settings["hosting"] = "one_process";
  return settings;
}

Configuration launched(const std::map<std::string, std::string>& settings) {
  Configuration configuration = parse_configuration(configuration_document(settings));
  const std::unique_ptr<FolderLock> lock = lock_output(configuration.run);
  if (const std::optional<Checkpoint> start = starting_point(configuration))
    configuration.run.first_realization = start->totals.count();
  return configuration;
}

Configuration replayed(const std::vector<std::string>& bags, const std::string& output) {
  return repeated({bags}, {{"output", output}, {"launch_id", output}});
}

Configuration behind_recorded_leader(std::mt19937_64& random, const std::vector<std::string>& bags,
                                     const std::string& output) {
  std::map<std::string, std::string> settings{{"output", output}, {"launch_id", output}, {"hosting", "one_process"}};
  if (any(random, 0, 1) == 0) {
    settings["followers"] = std::to_string(any(random, 1, 4));
    settings["external"] = "none";
  }
  if (any(random, 0, 1) == 0) settings["realizations"] = std::to_string(any(random, 1, 24));
  if (any(random, 0, 1) == 0) settings["seed"] = std::to_string(any(random, 1, 3));
  return repeated({bags}, settings, true);
}

std::string description(const Configuration& configuration) {
  const RunOptions& run = configuration.run;
  return "launch " + run.launch_id +
         formatted(": %zu followers, %lld steps, %llu realizations from %llu, batches of %llu", run.followers,
                   static_cast<long long>(run.steps), static_cast<unsigned long long>(run.realizations),
                   static_cast<unsigned long long>(run.first_realization), static_cast<unsigned long long>(run.batch)) +
         (run.record.empty() ? "" : ", recorded");
}

Configuration of_any_launch(Configuration configuration) {
  RunOptions& run = configuration.run;
  run.output = run.record = run.launch_id = "";
  run.first_realization = 0;
  run.resume = false;
  return configuration;
}

const std::string& reference(const Configuration& configuration) {
  static std::map<std::string, std::string> known;
  const Configuration plain = of_any_launch(configuration);
  const std::string key = to_json(plain).dump();
  const auto found = known.find(key);
  if (found != known.end()) return found->second;
  Configuration computed = plain;
  computed.run.external.clear();
  computed.run.hosting = Hosting::monte_carlo;
  const WholeRun run = compute_run(computed, {});
  return known[key] = statistics_csv(plain, predict(plain), run.result);
}

std::vector<std::string> recorded_files(const RunOptions& run) {
  if (run.record_split_mb == 0) return {run.record};
  std::vector<std::string> all;
  for (int part = 0;; ++part) {
    const std::string name = run.record.substr(0, run.record.size() - 4) + formatted("_%d.bag", part);
    if (!std::filesystem::exists(name)) return all;
    all.push_back(name);
  }
}

std::string problem_of(const Configuration& configuration, bool recorded) {
  const RunOptions& run = configuration.run;
  const std::string& wanted = reference(configuration);
  if (read_file(run.output + "/statistics.csv", kMostWrittenBytes) != wanted)
    return run.output + "/statistics.csv is not that of monte_carlo";
  if (!recorded) return "";
  try {
    const BagStatistics found = statistics_of_bags({recorded_files(run)}, [](std::uint64_t, std::uint64_t) {});
    if (!found.findings.empty()) return run.record + ": " + found.findings.front();
    if (!found.result.complete) return run.record + ": is not complete";
    if (statistics_csv(configuration, predict(configuration), found.result) != wanted)
      return run.record + " does not replay to the statistics of monte_carlo";
  } catch (const BagError& error) {
    return error.what();
  }
  return "";
}

std::string problem_of_endless(const Configuration& configuration, bool power_was_lost) {
  const RunOptions& run = configuration.run;
  const std::string file = left_recording(run.record);
  if (file.empty()) return "";
  std::map<std::uint64_t, std::vector<Position::ConstPtr>> positions;  // by realization, of all vehicles
  try {
    BagStream stream({{file}, power_was_lost ? Accept::damaged : Accept::cut},
                     [](const PlatoonTopic& topic) { return topic.kind == PlatoonTopic::Kind::position; });
    for (auto message = stream.next(); message; message = stream.next()) {
      const Position::Ptr& position = message->position();
      position->run = message->topic.vehicle;
      positions[first_noise_realization(run.schedule(), id_of(*position))].push_back(position);
    }
  } catch (const BagError& error) {
    return power_was_lost ? "" : error.what();
  }
  std::string problem;
  for (const auto& [realization, all] : positions) {
    const auto later = [](const auto& one, const auto& other) { return one->step < other->step; };
    const std::int64_t steps = (*std::max_element(all.begin(), all.end(), later))->step + 1;
    std::size_t vehicle = 0;
    for_each_trajectory(configuration.model, WhiteNoise(run.seed), run.followers, steps, realization, {},
                        [&](const Trajectory& trajectory) {
                          for (const Position::ConstPtr& position : all) {
                            const auto k = static_cast<std::size_t>(position->step + 1);
                            if (position->run == vehicle && position->position.at(0) != trajectory.position[k])
                              problem = formatted("%s: vehicle %zu, realization %llu, step %lld: %.17g m", file.c_str(),
                                                  vehicle, static_cast<unsigned long long>(realization),
                                                  static_cast<long long>(position->step), position->position[0]);
                          }
                          ++vehicle;
                        });
  }
  return problem;
}

}  // namespace platoon::simulation
