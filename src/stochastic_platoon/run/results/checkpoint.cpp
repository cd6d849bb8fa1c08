#include "stochastic_platoon/run/results/checkpoint.hpp"

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <utility>
#include <vector>

#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/run/configuration/configuration_error.hpp"
#include "stochastic_platoon/run/io/atomic_file.hpp"
#include "stochastic_platoon/run/io/digest.hpp"
#include "stochastic_platoon/run/io/printable.hpp"
#include "stochastic_platoon/run/io/read_file.hpp"
#include "stochastic_platoon/run/results/identity_differences.hpp"
#include "stochastic_platoon/run/results/result_files.hpp"

namespace platoon {

namespace {

constexpr std::size_t kMostCells = 20000000;  // limit for every run
constexpr char kFormat[] = "stochastic_platoon checkpoint 3";

nlohmann::json to_json(const MomentTable& table) {
  nlohmann::json blocks = nlohmann::json::array();
  for (const auto& entry : table.blocks()) {
    const MomentBlock& block = entry.second;
    blocks.push_back({{"first", block.range.first},
                      {"level", block.range.level},
                      {"mean", block.mean},
                      {"squared_deviations", block.squared_deviations}});
    if (block.fourth_deviations.empty()) continue;
    blocks.back()["cubed_deviations"] = block.cubed_deviations;
    blocks.back()["fourth_deviations"] = block.fourth_deviations;
  }
  return blocks;
}

nlohmann::json to_json(const GapTable& table) {
  nlohmann::json followers = nlohmann::json::array();
  for (const FollowerGaps& of : table.followers()) {
    nlohmann::json bins = nlohmann::json::array(), counts = nlohmann::json::array();
    for (const auto& [bin, count] : of.histogram) {
      bins.push_back(bin);
      counts.push_back(count);
    }
    followers.push_back({{"smallest", of.smallest.gap},
                         {"realization", of.smallest.realization},
                         {"step", of.smallest.step},
                         {"collisions", of.collisions},
                         {"unsafe", of.unsafe},
                         {"bins", bins},
                         {"counts", counts}});
  }
  nlohmann::json document = {{"bin_width", table.counting().bin_width}, {"followers", followers}};
  if (table.counting().safe_gap) document["safe_gap"] = *table.counting().safe_gap;
  return document;
}

GapTable gaps_from_json(const nlohmann::json& document) {
  const nlohmann::json& followers = document.at("followers");
  GapCounting counting{followers.size(), document.at("bin_width").get<double>()};
  if (document.contains("safe_gap")) counting.safe_gap = document.at("safe_gap").get<double>();
  GapTable table(counting);
  for (std::size_t i = 0; i < followers.size(); ++i) {
    const nlohmann::json& row = followers[i];
    FollowerGaps of{{row.at("smallest").get<double>(), row.at("realization").get<std::uint64_t>(),
                     row.at("step").get<std::int64_t>()},
                    row.at("collisions").get<std::uint64_t>(),
                    row.at("unsafe").get<std::uint64_t>()};
    const nlohmann::json &bins = row.at("bins"), &counts = row.at("counts");
    for (std::size_t j = 0; j < bins.size(); ++j)
      of.histogram[bins.at(j).get<std::int64_t>()] = counts.at(j).get<std::uint64_t>();
    table.merge(i + 1, of);
  }
  return table;
}

LimitTable limits_from_json(const nlohmann::json& followers) {
  LimitTable table(followers.size());
  for (std::size_t i = 0; i < followers.size(); ++i) table.add(i + 1, followers[i].get<AtLimits>());
  return table;
}

nlohmann::json to_json(const std::vector<Moments>& averages) {
  nlohmann::json rows = nlohmann::json::array();
  for (const Moments& of : averages) rows.push_back({of.count, of.mean, of.squared_deviations});
  return rows;
}

Checkpoint from_json(const nlohmann::json& document) {
  const auto cells = document.at("cells").get<std::size_t>();
  if (cells > kMostCells) throw std::runtime_error(std::to_string(cells) + " cells: must be fewer");
  EnsembleTotals totals{MomentTable(cells)};
  for (const nlohmann::json& block : document.at("blocks")) {
    totals.moments.add({{block.at("first").get<std::uint64_t>(), block.at("level").get<unsigned>()},
                        block.at("mean").get<std::vector<double>>(),
                        block.at("squared_deviations").get<std::vector<double>>(),
                        block.value("cubed_deviations", std::vector<double>()),
                        block.value("fourth_deviations", std::vector<double>())});
  }
  if (document.contains("gaps")) totals.gaps = gaps_from_json(document.at("gaps"));
  if (document.contains("limits")) totals.limits = limits_from_json(document.at("limits"));
  std::vector<Moments> averages;
  for (const nlohmann::json& row : document.at("time_averages")) {
    averages.push_back({row.at(0).get<std::uint64_t>(), row.at(1).get<double>(), row.at(2).get<double>()});
  }
  const nlohmann::json& tally = document.at("tally");
  return {document.at("identity"),
          document.at("launch_id").get<std::string>(),
          {tally.at("positions_received").get<std::uint64_t>(), tally.at("attempts").get<std::uint32_t>(),
           tally.at("wall_seconds").get<double>(), tally.at("platoon_time").get<std::uint64_t>()},
          std::move(totals),
          std::move(averages),
          {},
          document.value("shard", nlohmann::json())};
}

// The lines before the content.
std::string descriptor_of(const std::string& content) {
  return formatted("%s\n%016llx\n", kFormat, static_cast<unsigned long long>(digest(content)));
}

bool has_no_gap(const MomentTable& table) {
  std::uint64_t end = 0;
  for (const auto& entry : table.blocks()) {
    if (entry.second.range.first != end) return false;
    end = entry.second.range.end();
  }
  return true;
}

}  // namespace

void require_no_results(const std::string& output) {
  const bool statistics = may_exist(output + "/statistics.csv") && !may_exist(unfinished_summary_file(output));
  if (!statistics && !may_exist(output + "/summary.json") && !may_exist(output + "/rare.csv")) return;
  throw ConfigurationError(
      {"output: " + output +
       ": holds results already, which are never overwritten, and no checkpoint to continue from: must be another folder"});
}

std::string extent_of(const Checkpoint& checkpoint) {
  if (checkpoint.time_averages.empty()) return std::to_string(checkpoint.totals.count()) + " realizations";
  return "averages over " + std::to_string(checkpoint.time_averages.front().count) + " steps";
}

std::string checkpoint_file(const std::string& output) {
  return output + "/checkpoint.cbor";
}

std::string previous_checkpoint_file(const std::string& output) {
  return output + "/checkpoint.previous.cbor";
}

void write_checkpoint(const std::string& output, const Checkpoint& checkpoint) {
  nlohmann::json document = {{"identity", checkpoint.identity},
                             {"launch_id", checkpoint.launch_id},
                             {"tally",
                              {{"positions_received", checkpoint.tally.positions_received},
                               {"attempts", checkpoint.tally.attempts},
                               {"wall_seconds", checkpoint.tally.wall_seconds},
                               {"platoon_time", checkpoint.tally.platoon_time}}},
                             {"cells", checkpoint.totals.moments.cells()},
                             {"blocks", to_json(checkpoint.totals.moments)},
                             {"time_averages", to_json(checkpoint.time_averages)}};
  if (!checkpoint.totals.gaps.empty()) document["gaps"] = to_json(checkpoint.totals.gaps);
  if (!checkpoint.totals.limits.empty()) document["limits"] = checkpoint.totals.limits.followers();
  if (!checkpoint.shard.is_null()) document["shard"] = checkpoint.shard;
  const std::vector<std::uint8_t> bytes = nlohmann::json::to_cbor(document);
  const std::string content(bytes.begin(), bytes.end());
  // Between two renames there is no latest file; the previous one is then read.
  write_atomically(checkpoint_file(output), descriptor_of(content) + content, previous_checkpoint_file(output));
}

void remove_checkpoints(const std::string& output) {
  std::error_code ignored;
  std::filesystem::remove(checkpoint_file(output), ignored);
  std::filesystem::remove(previous_checkpoint_file(output), ignored);
}

namespace {

// Throws std::runtime_error with the file and the problem.
Checkpoint checkpoint_in(const std::string& file) {
  const std::string bytes = read_file(file, kMostWrittenBytes);
  const std::string any_heading = descriptor_of("");
  try {
    if (bytes.compare(0, sizeof kFormat - 1, kFormat) != 0)
      throw std::runtime_error(std::string("it does not begin with \"") + kFormat + "\"");
    if (bytes.size() < any_heading.size()) throw std::runtime_error("it is cut off");
    const std::string content = bytes.substr(any_heading.size());
    if (bytes.compare(0, any_heading.size(), descriptor_of(content)) != 0)
      throw std::runtime_error("its digest is not that of its content");
    return from_json(nlohmann::json::from_cbor(content));
  } catch (const std::exception& error) {
    throw DamagedCheckpoint(file + ": is not a checkpoint that can be read: " + error.what());
  }
}

}  // namespace

std::optional<Checkpoint> read_checkpoint(const std::string& output) {
  const std::string latest = checkpoint_file(output), previous = previous_checkpoint_file(output);
  std::string damage;
  if (may_exist(latest)) {
    try {
      return checkpoint_in(latest);
    } catch (const std::runtime_error& error) {
      if (!may_exist(previous)) throw;
      damage = error.what();
    }
  }
  if (!may_exist(previous)) return std::nullopt;
  Checkpoint checkpoint = checkpoint_in(previous);
  checkpoint.damage = damage;
  return checkpoint;
}

std::optional<Checkpoint> starting_point(const Configuration& configuration) {
  const RunOptions& run = configuration.run;
  try {
    require_writable_folder(run.output);
  } catch (const std::runtime_error& error) {
    throw ConfigurationError({std::string("output: ") + error.what() + ": must be a folder that can be written"});
  }
  std::optional<Checkpoint> found;
  try {
    found = read_checkpoint(run.output);
  } catch (const std::runtime_error& error) {
    throw ConfigurationError({std::string("output: ") + error.what()});
  }
  if (!found) {
    require_no_results(run.output);
    return std::nullopt;
  }
  if (!found->shard.is_null())
    throw ConfigurationError({"output: " + run.output + ": holds a shard of a run: must be another folder"});
  const bool same_launch = found->launch_id == run.launch_id && !run.launch_id.empty();
  if (!same_launch && !run.resume) {
    throw ConfigurationError({"output: " + run.output + ": holds a run of " + extent_of(*found) +
                              ": must be another folder (or resume:=true to continue that run)"});
  }
  const std::string differing = identity_differences(found->identity, statistics_identity(configuration));
  if (!differing.empty()) {
    throw ConfigurationError({"output: " + run.output + ": holds a run of another configuration: " + differing});
  }
  if (!has_no_gap(found->totals.moments)) {
    throw ConfigurationError({"output: " + checkpoint_file(run.output) +
                              ": must hold realizations 0, 1, ... without a gap: must be another folder"});
  }
  if (found->totals.count() > run.realizations) {
    throw ConfigurationError({"realizations: " + std::to_string(run.realizations) + ": must be at least the " +
                              std::to_string(found->totals.count()) + " that " + run.output + " holds already"});
  }
  return found;
}

namespace {

ConfigurationError no_output(const std::runtime_error& error) {
  return ConfigurationError(
      {std::string("output: ") + error.what() + ": must be a folder that can be written, and of one run"});
}

}  // namespace

void require_possible_output(const std::string& output, bool for_results) {
  if (output.empty()) throw ConfigurationError({"output: (empty): must be a folder"});
  try {
    require_possible_folder(output);
  } catch (const std::runtime_error& error) {
    throw no_output(error);
  }
  if (for_results && !may_exist(checkpoint_file(output)) && !may_exist(previous_checkpoint_file(output)))
    require_no_results(output);
}

std::unique_ptr<FolderLock> lock_output(const RunOptions& run) {
  try {
    require_writable_folder(run.output);
    if (run.launch_id.empty()) return std::make_unique<FolderLock>(run.output, "process " + std::to_string(::getpid()));
    // roslaunch restarts a killed monitor.
    const bool started_again = std::getenv(kEndsWithLaunch) != nullptr;
    return std::make_unique<FolderLock>(run.output, "launch " + run.launch_id, started_again ? ::getppid() : 0);
  } catch (const std::runtime_error& error) {
    throw no_output(error);
  }
}

}  // namespace platoon
