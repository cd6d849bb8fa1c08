// Makes one configuration of a model file and launch arguments, checks all of it, and prints it for the
// parameter server. platoon.launch runs it before any node starts: what is wrong is said once, and nothing is
// started or written over.

#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <iostream>

#include "stochastic_platoon/configuration/configuration.hpp"
#include "stochastic_platoon/results/checkpoint.hpp"
#include "tools/settings.hpp"

namespace {

std::string new_launch_name() {
  const std::time_t time = std::time(nullptr);
  char date[32];
  std::strftime(date, sizeof date, "%Y-%m-%d-%H-%M-%S", std::localtime(&time));
  return std::string(date) + "-" + std::to_string(::getpid());
}

// ROS keeps what it writes under ROS_HOME, by default ~/.ros.
std::string new_output_folder(const std::string& launch) {
  const char* ros_home = std::getenv("ROS_HOME");
  const char* home = std::getenv("HOME");
  if (ros_home == nullptr && home == nullptr) {
    throw platoon::ConfigurationError(
        {"output: (empty): must be a folder, as neither ROS_HOME nor HOME is set"});
  }
  return (ros_home != nullptr ? std::string(ros_home) : std::string(home) + "/.ros") +
         "/stochastic_platoon/" + launch;
}

}  // namespace

int main(int argc, char** argv) {
  std::set<std::string> accepted;
  for (const auto& entry : platoon::default_settings()) accepted.insert(entry.first);
  std::map<std::string, std::string> settings = platoon::parse_command_line(
      argc, argv, "Checks a platoon's configuration and prints it for the parameter server", accepted, {});
  try {
    if (settings["launch"].empty()) settings["launch"] = new_launch_name();
    if (settings["output"].empty()) settings["output"] = new_output_folder(settings["launch"]);
    settings["output"] = std::filesystem::absolute(settings["output"]).lexically_normal().string();
    const YAML::Node document = platoon::configuration_document(settings);
    const platoon::Configuration configuration = platoon::parse_configuration(document);
    if (configuration.run.steps > 0) platoon::starting_point(configuration);
    nlohmann::json printed = {{"model", platoon::to_json(configuration.model)},
                              {"run", platoon::to_json(configuration.run)}};
    std::cout << printed.dump(2) << "\n";
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "\nstochastic_platoon: the configuration is not valid: " << error.what() << "\n\n";
    return 1;
  }
}
