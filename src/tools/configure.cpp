// Combines a model file and launch arguments to one configuration, checks all of it, and prints it for the parameter
// server. platoon.launch runs it before any node starts, so that a problem is reported once, before anything is started
// or overwritten.

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <iostream>
#include <optional>

#include "stochastic_platoon/ros/bags/bag_statistics.hpp"
#include "stochastic_platoon/ros/bags/bag_writer.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"
#include "stochastic_platoon/run/configuration/configuration_document.hpp"
#include "stochastic_platoon/run/configuration/launch_arguments.hpp"
#include "stochastic_platoon/run/configuration/settings.hpp"
#include "stochastic_platoon/run/configuration/shipped_files.hpp"
#include "stochastic_platoon/run/configuration/single_number.hpp"
#include "stochastic_platoon/run/io/atomic_file.hpp"
#include "stochastic_platoon/run/io/read_file.hpp"
#include "stochastic_platoon/run/results/checkpoint.hpp"
#include "stochastic_platoon/run/results/provenance.hpp"
#include "tools/command_line.hpp"
#include "tools/free_namespace.hpp"

namespace {

std::string new_launch_name() {
  const std::time_t time = std::time(nullptr);
  char date[32];
  std::strftime(date, sizeof date, "%Y-%m-%d-%H-%M-%S", std::localtime(&time));
  return std::string(date) + "-" + std::to_string(::getpid());
}

// ROS writes its files to ROS_HOME, by default ~/.ros; none if neither ROS_HOME nor HOME is set.
std::optional<std::string> ros_home() {
  if (const char* folder = std::getenv("ROS_HOME")) return folder;
  if (const char* home = std::getenv("HOME")) return std::string(home) + "/.ros";
  return std::nullopt;
}

std::string new_output_folder(const std::string& launch) {
  const std::optional<std::string> home = ros_home();
  if (!home)
    throw platoon::ConfigurationError({"output: (empty): must be a folder, as neither ROS_HOME nor HOME is set"});
  return *home + "/stochastic_platoon/" + launch;
}

// The folder in which roslaunch and every node keep their logs. Without it the nodes fail one by one with an obscure
// message.
void require_log_folder() {
  const char* log_folder = std::getenv("ROS_LOG_DIR");
  const std::string folder = log_folder != nullptr ? log_folder : ros_home() ? *ros_home() + "/log" : "";
  if (folder.empty()) return;
  try {
    platoon::require_writable_folder(folder);
  } catch (const std::runtime_error& error) {
    throw platoon::ConfigurationError(
        {std::string("ROS_LOG_DIR: ") + error.what() +
         ": must be a folder that can be written, as every node keeps its log there (unset: log under ROS_HOME, or .ros/log under HOME)"});
  }
}

// Without a slash at the end: the names of further runs are formed by appending to it.
std::string absolute(const std::string& path) {
  const std::filesystem::path normal = std::filesystem::absolute(path).lexically_normal();
  return (normal.has_filename() ? normal : normal.parent_path()).string();
}

// The names of recordings for a node, whose working folder is another, as a text for bag_files().
std::string absolute_names(const std::string& bags) {
  std::string names;
  for (const std::string& file : platoon::bag_files(bags))
    names += (names.empty() ? "" : " ") + std::filesystem::absolute(file).string();
  if (platoon::bag_files(names).size() != platoon::bag_files(bags).size())
    throw platoon::ConfigurationError(
        {"bag: " + names + ": must be one file, or files in folders whose names have no spaces"});
  return names;
}

// Throws ConfigurationError unless `first` and `last` name vehicles of a string of `most`: at least one for followers
// that outlive launches, while a platoon may leave all its followers to them, with `last` = `first` - 1.
void require_range(const platoon::CommandLine& line, std::int64_t most, bool kept) {
  platoon::ProblemCollector problems;
  const auto vehicle = [&](const char* key, std::int64_t least, std::int64_t greatest) {
    const auto number = problems.result_of([&] { return platoon::integer_of(key, line[key], least, greatest); });
    if (const std::string digits = std::to_string(number.value_or(1)); number && digits != line[key])
      problems.add(std::string(key) + ": " + line[key] + ": must be written " + digits +
                   ", in digits alone, as launch files read it too (last:= is followers:= by default)");
    return number.value_or(1);
  };
  if (line.has("first") && line.has("last")) {
    const std::int64_t first = vehicle("first", 1, kept ? most : most + 1);
    vehicle("last", kept ? first : first - 1, most);
  }
  problems.require_none();
}

// The external vehicles of followers.launch, which may be of any platoon. Throws ConfigurationError.
std::vector<std::size_t> external_vehicles(const platoon::CommandLine& line) {
  const auto given = line.settings.find("external");
  if (given == line.settings.end()) return {};
  YAML::Node document;
  document["external"] = given->second;
  std::vector<std::string> problems;
  platoon::Section section(document, "", problems);
  std::vector<std::size_t> external = platoon::read_external(section, platoon::kMaxFollowers);
  if (!problems.empty()) throw platoon::ConfigurationError(problems);
  return external;
}

// Throws ConfigurationError if a part of the string is to run in one process.
void require_all_in_one_process(const platoon::CommandLine& line, const platoon::RunOptions& run) {
  const bool all = !line.has("first") || (line["first"] == "1" && line["last"] == std::to_string(run.followers));
  if (run.hosting == platoon::Hosting::one_process && !all)
    throw platoon::ConfigurationError({"first, last: " + line["first"] + ", " + line["last"] + ": must be 1 and " +
                                       std::to_string(run.followers) +
                                       " with hosting:=one_process, which runs all vehicles"});
}

// The largest number of a vehicle where the configuration is faulty, and with it perhaps the number of followers; none
// if `last` repeats that one's fault, as it does by default.
std::optional<std::int64_t> given_followers(const platoon::CommandLine& line) {
  std::string given = line.setting("followers");
  for (const platoon::Setting& setting : platoon::settings()) {
    if (given.empty() && line["bag"].empty() && setting.name == std::string("followers")) given = setting.default_value;
  }
  if (given.empty()) return platoon::kMaxFollowers;  // those of the recording
  const auto number = platoon::ProblemCollector().result_of(
      [&] { return platoon::integer_of("followers", given, 1, platoon::kMaxFollowers); });
  if (!number && line["last"] == given) return std::nullopt;
  return number.value_or(platoon::kMaxFollowers);
}

// Adds what would change a run that is replayed as recorded.
void require_as_recorded(const std::map<std::string, std::string>& settings, platoon::ProblemCollector& problems) {
  for (const auto& entry : settings) {
    if (!entry.second.empty() && entry.first != "output" && entry.first != "external" && entry.first != "launch_id")
      problems.add(entry.first + ": given: must be with drive:=leader, as the run is replayed as recorded");
  }
}

// The settings that are given to the launch file.
std::map<std::string, std::string> not_empty(const std::map<std::string, std::string>& settings) {
  std::map<std::string, std::string> found;
  for (const auto& entry : settings) {
    if (!entry.second.empty()) found.insert(entry);
  }
  return found;
}

// Throws ConfigurationError unless the recording holds what the argument `drive` of a replay names.
void require_drive(const std::string& drive, const platoon::RunOptions& recorded) {
  if (drive == "leader" && recorded.averaging() == platoon::Averaging::over_time) {
    throw platoon::ConfigurationError(
        {"drive: leader: the recording is of an endless run: must be of a run with steps above 0. rosrun stochastic_platoon export writes the speeds of its leader, of which a table for leader:= can be made"});
  }
  if (drive.empty() || drive == "leader") return;
  for (std::size_t i = 1; i <= recorded.followers; ++i) {
    if (drive == platoon::vehicle_name(i)) return;
  }
  throw platoon::ConfigurationError({"drive: " + drive + ": must be leader, or one of vehicle_1 to " +
                                     platoon::vehicle_name(recorded.followers) +
                                     ", the recorded followers; empty: all positions into the monitor"});
}

}  // namespace

int configure_main(int argc, char** argv) {
  std::set<std::string> all_settings{"model"};
  for (const platoon::Setting& setting : platoon::settings()) all_settings.insert(setting.name);
  const platoon::CommandLine line = platoon::parse_command_line(
      argc, argv,
      {"Checks a platoon's configuration and prints it for the parameter server\n"
       "Example: configure --model acc.yaml --followers 5",
       all_settings,
       {{"bag",
         "recordings to replay, separated by spaces: their run is repeated; with --drive leader, settings change it"},
        {"bag_names", "prints the absolute names of these recordings, separated by spaces, and nothing else"},
        {"ns", "namespace of the platoon, which must be free"},
        {"drive",
         "of a replay, which needs --bag: what the recording drives, leader or a vehicle as vehicle_3; empty: the monitor"},
        {"first", "first vehicle that the launch starts"},
        {"last", "last vehicle that the launch starts"},
        {"dashboard_port", "port of the page; 0: any free one"},
        {"kept", "true: check the arguments of followers.launch, and nothing else"},
        {"quote_in_path", "true: reject a quote in a path, which a launch file cannot pass on"},
        {"replay_rate", "of a replay: its argument rate"},
        {"start", "of a replay: its argument start"},
        {"pause", "of a replay: its argument pause"},
        {"patience", "of a replay: its argument patience"},
        {"dashboard", "of a replay: its argument dashboard"},
        {"stay", "of a replay: its argument stay"},
        {"unverified", "true: with --bag, also of recordings without checksums"}}});
  try {
    if (line["quote_in_path"] == "true") {
      throw platoon::ConfigurationError(
          {"model, output, record, bag: a path with a quote ('): must be without, as a launch file cannot pass it on (a symbolic link can give it another name)"});
    }
    if (line.has("bag_names")) {
      std::cout << absolute_names(line["bag_names"]);
      return 0;
    }
    platoon::ProblemCollector problems;
    problems.add(platoon::undeclared_arguments(platoon::command_line(), platoon::package_folder() + "/launch"));
    if (line["kept"] == "true") {
      problems.check([&] { require_range(line, platoon::kMaxFollowers, true); });
      const auto external = problems.result_of([&] { return external_vehicles(line); });
      problems.require_none();
      platoon::require_free_vehicles(line, *external);
      return 0;
    }
    problems.check(require_log_folder);
    const bool recorded_leader = line["drive"] == "leader";
    const auto bags = problems.result_of([&] {
      if (line.has("drive") && line["bag"].find_first_not_of(' ') == std::string::npos)
        throw platoon::ConfigurationError({"bag: missing: must be a recording to replay, as in bag:=/tmp/run.bag"});
      return platoon::BagSource{platoon::bag_files(line["bag"]), platoon::Accept::whole,
                                platoon::is_true(line["unverified"])};
    });
    if (bags && line.has("drive")) {
      problems.check([&] { require_drive(line["drive"], platoon::configuration_to_repeat(*bags).run); });
      std::map<std::string, std::string> given = line.options;
      given.insert(line.settings.begin(), line.settings.end());
      problems.add(platoon::ineffective_arguments(given));
    }
    if (bags && !bags->files.empty() && !recorded_leader) require_as_recorded(line.settings, problems);
    const bool is_replayable = line["bag"].empty() || problems.all().empty();
    std::map<std::string, std::string> settings = line.settings;
    if (settings["launch_id"].empty()) settings["launch_id"] = new_launch_name();
    problems.check([&] {
      if (settings["output"].empty()) settings["output"] = new_output_folder(settings["launch_id"]);
      settings["output"] = absolute(settings["output"]);
    });
    if (!settings["record"].empty()) settings["record"] = absolute(settings["record"]);
    // A replay whose own arguments are faulty has no configuration to judge.
    std::optional<platoon::Configuration> found;
    if (bags && is_replayable) {
      found = problems.result_of([&] {
        return bags->files.empty() ? platoon::parse_configuration(platoon::configuration_document(settings))
                                   : platoon::repeated(*bags, not_empty(settings), recorded_leader);
      });
    }
    const auto most = found ? static_cast<std::int64_t>(found->run.followers) : given_followers(line);
    problems.check([&] {
      if (most) require_range(line, *most, false);
    });
    problems.check([&] {
      if (found) require_all_in_one_process(line, found->run);
    });
    problems.check([&] { platoon::require_port("dashboard_port", line["dashboard_port"]); });
    problems.check(
        [&] { platoon::require_free_namespace(line, found ? std::optional(found->run.external) : std::nullopt); });
    const std::string& split = settings["record_split_mb"];
    const bool in_parts = found ? found->run.record_split_mb > 0 : !split.empty() && split != "0";
    problems.check([&] { platoon::require_free_recording(settings["record"], in_parts); });
    std::unique_ptr<platoon::FolderLock> lock;
    std::optional<platoon::Checkpoint> start;
    const auto take_output = [&] {
      lock = platoon::lock_output(found->run);
      start = platoon::starting_point(*found);
    };
    const std::string& output = settings["output"];
    problems.check([&] {
      if (output.empty()) return;  // a fault above
      if (found && platoon::may_exist(output)) return take_output();
      platoon::require_possible_output(output);  // it is made once there is no fault
    });
    problems.require_none();
    if (!lock) take_output();
    platoon::Configuration& configuration = *found;
    if (start) configuration.run.first_realization = start->totals.count();
    lock->leave_claim(::getppid());  // until the monitor of this launch starts; roslaunch is the parent
    std::cout << platoon::to_json(configuration).dump() << "\n";
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "\nstochastic_platoon: the configuration is not valid: " << error.what() << "\n\n";
    return 1;
  }
}
