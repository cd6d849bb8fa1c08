// The conformance test of an external vehicle: tests vehicle I alone against the vehicle contract (msg/README.md) and
// prints a verdict for each clause. Exits with status 0 if all clauses hold.

#include <ros/init.h>
#include <ros/master.h>

#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <set>
#include <stdexcept>

#include "stochastic_platoon/ros/external/vehicle_check.hpp"
#include "stochastic_platoon/ros/messages/topics.hpp"
#include "stochastic_platoon/ros/transport/publishers.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"
#include "stochastic_platoon/run/configuration/configuration_document.hpp"
#include "stochastic_platoon/run/configuration/shipped_files.hpp"
#include "tools/settings.hpp"

namespace {

constexpr char kNumber[] = "the number of a follower, 1 or more";

struct Arguments {
  std::size_t vehicle = 0;
  double patience = 2.0, wait = 30.0;  ///< [s]
  std::map<std::string, std::string> settings;
};

double seconds_of(std::map<std::string, std::string>& settings, const std::string& key, double otherwise) {
  if (settings.count(key) == 0) return otherwise;
  char* end = nullptr;
  const std::string text = settings[key];
  const double seconds = std::strtod(text.c_str(), &end);
  settings.erase(key);
  if (*end == '\0' && !text.empty() && seconds > 0.0 && seconds <= 1e6) return seconds;
  throw platoon::ConfigurationError({key + ": " + text + ": must be a number of seconds above 0"});
}

Arguments parsed(int argc, char** argv) {
  Arguments arguments;
  const bool numbered = argc > 1 && argv[1][0] != '-';
  if (numbered) {
    const char* end = argv[1] + std::strlen(argv[1]);
    const auto read = std::from_chars(static_cast<const char*>(argv[1]), end, arguments.vehicle);
    if (read.ec != std::errc() || read.ptr != end || arguments.vehicle < 1 || arguments.vehicle > 1000000)
      throw platoon::ConfigurationError({std::string("vehicle: ") + argv[1] + ": must be " + kNumber});
    argv[1] = argv[0];
  }
  arguments.settings = platoon::parse_command_line(
      argc - (numbered ? 1 : 0), argv + (numbered ? 1 : 0),
      "check_vehicle I: drives vehicle I alone through the vehicle contract, a verdict for each clause",
      {"model", "headway", "headway_seconds"},
      {{"patience", "seconds to wait for an answer (2)"}, {"wait", "seconds to wait for the vehicle (30)"}});
  if (!numbered) throw platoon::ConfigurationError({std::string("vehicle: missing: must be ") + kNumber});
  arguments.patience = seconds_of(arguments.settings, "patience", arguments.patience);
  arguments.wait = seconds_of(arguments.settings, "wait", arguments.wait);
  if (arguments.settings.count("model") == 0) arguments.settings["model"] = platoon::paper_model_file();
  return arguments;
}

// Two batches, of 1000 and of 1 realizations, from the nominal initial positions.
platoon::Configuration run_of(const Arguments& arguments, const std::string& name) {
  std::map<std::string, std::string> settings = arguments.settings;
  settings["followers"] = std::to_string(arguments.vehicle);
  settings["steps"] = arguments.vehicle > 100000 ? "20" : "200";
  settings["realizations"] = "1001";
  settings["batch"] = "1000";
  settings["launch_id"] = name;
  platoon::Configuration configuration = platoon::parse_configuration(platoon::configuration_document(settings));
  for (platoon::VehicleType& type : configuration.model.types) type.vehicle.initial_position = {};
  return configuration;
}

// Throws if a platoon is running, because the test would disturb its run.
void require_no_run(const ros::NodeHandle& platoon) {
  const std::string topic = platoon.resolveName(platoon::kConfigurationTopic);
  const std::vector<std::string> names = platoon::registered_publishers(topic);
  if (names.empty()) return;
  throw std::runtime_error(names.front() + " publishes " + topic +
                           ": a platoon is there; end it, or use another master or namespace (ROS_NAMESPACE)");
}

// Restores the parameter at the end.
class KeptConfiguration {
public:
  explicit KeptConfiguration(const ros::NodeHandle& platoon) : platoon_(platoon) {
    std::string text;
    if (platoon_.getParam("configuration", text)) text_ = text;
  }
  ~KeptConfiguration() {
    if (text_) platoon_.setParam("configuration", *text_);
    if (!text_) platoon_.deleteParam("configuration");
  }
  KeptConfiguration(const KeptConfiguration&) = delete;
  KeptConfiguration& operator=(const KeptConfiguration&) = delete;

private:
  ros::NodeHandle platoon_;
  std::optional<std::string> text_;
};

void print(platoon::Clause clause, const char* verdict, const std::string& what = "") {
  std::printf("%2d %-12s %s\n", static_cast<int>(clause) + 1, verdict, platoon::to_string(clause));
  if (!what.empty()) std::printf("   %s\n", what.c_str());
  std::fflush(stdout);
}

void check(const ros::NodeHandle& platoon, const Arguments& arguments) {
  require_no_run(platoon);
  const KeptConfiguration kept(platoon);
  platoon::VehicleCheck check(platoon, run_of(arguments, "check_vehicle"),
                              run_of(arguments, "check_vehicle, another run"), arguments.vehicle, arguments.patience);
  const std::string name = "vehicle_" + std::to_string(arguments.vehicle);
  if (!check.wait_for_vehicle(0.5)) {
    std::printf("waiting for external %s: start its node\n", name.c_str());
    std::fflush(stdout);
    if (!check.wait_for_vehicle(arguments.wait)) {
      throw std::runtime_error(name + " is not running: it must publish " +
                               platoon.resolveName(platoon::position_topic(arguments.vehicle)) + " and subscribe to " +
                               platoon.resolveName(platoon::predecessor_position_topic(arguments.vehicle)));
    }
  }
  std::set<platoon::Clause> held;
  const auto breach = check.run([&held](platoon::Clause clause) {
    held.insert(clause);
    print(clause, "holds");
  });
  if (!breach) {
    std::printf("%s keeps the vehicle contract\n", name.c_str());
    return;
  }
  for (const platoon::Clause clause : platoon::kVehicleContract) {
    if (clause == breach->clause) {
      print(clause, "BROKEN", breach->what());  // even if it held at first: a second publisher may appear later
    } else if (held.count(clause) == 0) {
      print(clause, "not reached");
    }
  }
  throw std::runtime_error(name + " breaks " + platoon::named(breach->clause));
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  ros::init(argc, argv, "check_vehicle", ros::init_options::AnonymousName | ros::init_options::NoRosout);
  try {
    arguments = parsed(argc, argv);
    if (!ros::master::check())
      throw std::runtime_error("no ROS master at " + ros::master::getURI() + ": start roscore");
    check(ros::NodeHandle("platoon"), arguments);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "check_vehicle: %s\n", error.what());
    return 1;
  }
}
