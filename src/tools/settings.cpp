#include "tools/settings.hpp"

#include <algorithm>
#include <boost/program_options.hpp>
#include <cstdlib>
#include <filesystem>
#include <iostream>

#include "stochastic_platoon/configuration/version.hpp"

namespace platoon {

namespace {

namespace options = boost::program_options;

const std::map<std::string, std::string>& setting_help() {
  static const std::map<std::string, std::string> help = {
      {"model", "model file (YAML); without it the paper's example"},
      {"headway", "time headway h > 0 in sample periods; empty: the model file's"},
      {"noise_variance", "channel noise variance P_d >= 0 [m^2]; empty: the model file's"},
      {"followers", "number of followers N (20)"},
      {"steps", "steps per realization (100); 0: one endless batch with time averages"},
      {"realizations", "number of realizations (10000)"},
      {"batch", "realizations per message; 0: choose"},
      {"rate", "steps per second of wall time; 0: as fast as possible"},
      {"seed", "seed of the noise (1)"},
      {"hosting", "processes or one_process"},
      {"output", "folder for the results; empty: a new one under the ROS home"},
      {"resume", "true: go on with the run in the output folder"},
      {"first_realization", "realizations before it come from earlier launches (set by configure)"},
      {"record", "bag to record to; empty: none"},
      {"record_split_mb", "begin another bag beyond this size in MiB; 0: one bag"},
      {"record_compression", "none or lz4"},
      {"leader_bags", "bags whose vehicle 0 is the leader, separated by spaces"},
      {"launch", "name of this launch; empty: a new one"},
      {"window", "steps in flight; 0: choose"},
      {"stall_timeout", "seconds without progress before a batch is begun again (2.0)"},
      {"burn_in", "steps left out of time averages (200)"},
  };
  return help;
}

// The settings are named as the launch arguments, the options as is usual on a command line.
std::string option_name(std::string setting) {
  std::replace(setting.begin(), setting.end(), '_', '-');
  return setting;
}

}  // namespace

std::map<std::string, std::string> parse_command_line(int argc, char** argv, const std::string& purpose,
                                                      const std::set<std::string>& accepted,
                                                      const std::map<std::string, std::string>& extra) {
  std::map<std::string, std::string> help = extra;
  for (const std::string& name : accepted) help[name] = setting_help().at(name);
  options::options_description description(purpose);
  description.add_options()("help", "print this")("version", "print the version");
  for (const auto& entry : help) {
    description.add_options()(option_name(entry.first).c_str(), options::value<std::string>(),
                              entry.second.c_str());
  }
  std::map<std::string, std::string> settings;
  try {
    options::variables_map values;
    // No abbreviations: a mistyped option must not be taken for another.
    const int style = options::command_line_style::unix_style & ~options::command_line_style::allow_guessing;
    const options::positional_options_description no_positionals;
    options::store(options::command_line_parser(argc, argv)
                       .options(description)
                       .positional(no_positionals)
                       .style(style)
                       .run(),
                   values);
    if (values.count("help") > 0) {
      std::cout << description;
      std::exit(0);
    }
    if (values.count("version") > 0) {
      std::cout << "stochastic_platoon " << kVersion << "\n";
      std::exit(0);
    }
    for (const auto& entry : help) {
      if (values.count(option_name(entry.first)) > 0)
        settings[entry.first] = values[option_name(entry.first)].as<std::string>();
    }
  } catch (const options::error& error) {
    std::cerr << argv[0] << ": " << error.what() << "; --help lists the options\n";
    std::exit(2);
  }
  return settings;
}

std::string paper_model_file() {
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe");
  const std::filesystem::path installed =
      program.parent_path() / "../../share/stochastic_platoon/config/paper.yaml";
  if (std::filesystem::exists(installed)) return installed.lexically_normal().string();
  return PLATOON_SOURCE_DIR "/config/paper.yaml";
}

}  // namespace platoon
