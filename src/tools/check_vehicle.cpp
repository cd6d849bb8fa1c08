// The conformance test of an external vehicle: tests vehicle I alone against the vehicle contract (msg/README.md) and
// prints a verdict for each clause. Exits with status 0 if all clauses hold.

#include <ros/init.h>
#include <ros/master.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <optional>
#include <set>
#include <stdexcept>

#include "stochastic_platoon/ros/external/vehicle_check.hpp"
#include "stochastic_platoon/ros/messages/topics.hpp"
#include "stochastic_platoon/ros/transport/publishers.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"
#include "stochastic_platoon/run/configuration/configuration_document.hpp"
#include "stochastic_platoon/run/configuration/configuration_error.hpp"
#include "stochastic_platoon/run/configuration/single_number.hpp"
#include "stochastic_platoon/run/delivery/vehicle_name.hpp"
#include "tools/command_line.hpp"

namespace {

struct Arguments {
  std::size_t vehicle = 0;
  double patience = 0.0, wait = 0.0;  ///< [s]
  platoon::Configuration run;         ///< launch_id: a name that no check has had
};

// A vehicle remembers the attempts of its latest run, also of an interrupted check.
std::string launch_of_check() {
  return "check_vehicle " + std::to_string(std::time(nullptr)) + "-" + std::to_string(::getpid());
}

// Two batches, of 1000 and of 1 realizations, from the nominal initial positions. Without `followers` the platoon ends
// with the last one that may hear the vehicle.
platoon::Configuration run_of(std::map<std::string, std::string> settings, std::int64_t vehicle,
                              const std::optional<std::int64_t>& followers) {
  settings["realizations"] = "1001";
  settings["batch"] = "1000";
  settings["launch_id"] = launch_of_check();
  const auto run_with = [&settings](std::int64_t number) {
    settings["followers"] = std::to_string(number);
    // A run has 20 million vehicle-steps at most.
    settings["steps"] = std::to_string(number > 100000 ? platoon::VehicleCheck::kFewestSteps : 200);
    return platoon::parse_configuration(platoon::configuration_document(settings));
  };
  platoon::Configuration configuration = run_with(followers.value_or(vehicle));
  if (!followers) {
    const auto behind = static_cast<std::int64_t>(platoon::farthest_ahead(configuration.model));
    configuration = run_with(std::min(vehicle + behind, platoon::kMaxFollowers));
  }
  for (platoon::VehicleType& type : configuration.model.types) type.vehicle.initial_position = {};
  return configuration;
}

Arguments parsed(int argc, char** argv) {
  const platoon::CommandLine given = platoon::parse_command_line(
      argc, argv,
      {"check_vehicle I: drives vehicle I alone through the vehicle contract, a verdict for each clause\n"
       "Example: check_vehicle 2 --model acc.yaml",
       {"model", "headway", "headway_seconds"},
       {{"followers",
         "of the platoon (all that may hear the vehicle): if one of them hears its input by radio, that is tested, too"},
        {"patience", "seconds to wait for an answer (2)"},
        {"wait", "seconds to wait for the vehicle (30)"}},
       true});
  platoon::ProblemCollector problems;
  const auto seconds = [&](const char* option, double otherwise) {
    const auto number = [&] {
      return given.has(option) ? platoon::number_of(option, given[option], platoon::kPositive) : otherwise;
    };
    return problems.result_of(number).value_or(otherwise);
  };
  const auto of_words = [&given] {
    if (given.words.size() != 1)
      throw platoon::ConfigurationError({"check_vehicle I: must be given the number of one vehicle"});
    return platoon::integer_of("vehicle", given.words.front(), 1, platoon::kMaxFollowers);
  };
  const std::int64_t vehicle = problems.result_of(of_words).value_or(1);
  std::optional<std::int64_t> followers;
  if (given.has("followers")) {
    followers = problems.result_of(
        [&] { return platoon::integer_of("followers", given["followers"], vehicle, platoon::kMaxFollowers); });
  }
  const double patience = seconds("patience", 2.0), wait = seconds("wait", 30.0);
  const auto run = problems.result_of([&] { return run_of(given.settings, vehicle, followers); });
  problems.require_none();
  return {static_cast<std::size_t>(vehicle), patience, wait, *run};
}

// Throws if a platoon is running, because the test would disturb its run.
void require_no_run(const ros::NodeHandle& platoon) {
  const std::string topic = platoon.resolveName(platoon::kConfigurationTopic);
  const std::vector<std::string> names = platoon::registered_publishers(topic);
  if (names.empty()) return;
  throw std::runtime_error(
      names.front() + " publishes " + topic +
      ": a platoon runs in this namespace: end it, or use another master or namespace (ROS_NAMESPACE)");
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
  platoon::Configuration next = arguments.run;
  next.run.launch_id += ", another run";
  platoon::VehicleCheck check(platoon, arguments.run, next, arguments.vehicle, arguments.patience);
  const std::string name = platoon::vehicle_name(arguments.vehicle);
  if (!check.wait_for_vehicle(platoon::kLinkTime + 0.5)) {
    std::printf("waiting for external %s: start its node\n", name.c_str());
    std::fflush(stdout);
    if (!check.wait_for_vehicle(arguments.wait)) {
      if (!ros::ok()) throw std::runtime_error("interrupted: no verdict");
      throw std::runtime_error(name + " is not running: it must " + check.missing_links());
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

int check_vehicle_main(int argc, char** argv) {
  ros::init(argc, argv, "check_vehicle", ros::init_options::AnonymousName | ros::init_options::NoRosout);
  try {
    const Arguments arguments = parsed(argc, argv);
    if (!ros::master::check())
      throw std::runtime_error("no ROS master at " + ros::master::getURI() + ": start roscore");
    check(ros::NodeHandle("platoon"), arguments);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "check_vehicle: %s\n", error.what());
    return 1;
  }
}
