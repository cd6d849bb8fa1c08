// Ends the launch when all receivers report that they have finished. As a required node it also ends the launch when it
// is killed.

#include <stochastic_platoon/Progress.h>

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <map>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "stochastic_platoon/ros/hosting/run_component.hpp"
#include "stochastic_platoon/ros/messages/topics.hpp"
#include "stochastic_platoon/ros/transport/run_membership.hpp"
#include "stochastic_platoon/ros/transport/sole_publisher.hpp"
#include "stochastic_platoon/run/configuration/configuration_error.hpp"
#include "stochastic_platoon/run/results/checkpoint.hpp"
#include "stochastic_platoon/run/results/provenance.hpp"

namespace {

using stochastic_platoon::Progress;

// Whether each receiver has finished. Like the leader, it accepts a receiver's reports from one node only.
class Finished {
public:
  Finished(const ros::NodeHandle& platoon, const platoon::Configuration& configuration,
           platoon::RunMembership::Join superseded)
      : membership_(platoon, "until_complete", platoon::run_identity(configuration), std::move(superseded)),
        stays_(ros::NodeHandle("~").param("stay", false)) {
    const std::string topic = platoon.resolveName(platoon::kProgressTopic);
    for (const std::string& name : configuration.run.receivers())
      receivers_.emplace(name, Receiver{platoon::SolePublisher(topic + " of " + name), false});
  }

  void receive(const ros::MessageEvent<const Progress>& event) {
    const Progress::ConstPtr message = event.getMessage();
    const auto found = receivers_.find(message->receiver);
    if (!membership_.admits(message->run) || found == receivers_.end()) return;
    Receiver& receiver = found->second;
    if (receiver.reporter.admits(event.getConnectionHeaderPtr(), message->run)) receiver.finished = message->finished;
    const bool all =
        std::all_of(receivers_.begin(), receivers_.end(), [](const auto& entry) { return entry.second.finished; });
    if (!all || std::exchange(ended_, true)) return;
    if (!stays_) return platoon::end_launch();
    std::printf("The run is complete. Its nodes stay up until Ctrl-C.\n");
    std::fflush(stdout);
  }

private:
  struct Receiver {
    platoon::SolePublisher reporter;
    bool finished;
  };
  platoon::RunMembership membership_;
  std::map<std::string, Receiver> receivers_;
  bool stays_, ended_ = false;
};

// Starts `check` with these arguments. Returns its process, 0 if there is none.
pid_t start_check(std::vector<std::string> words) {
  const std::string check = std::filesystem::read_symlink("/proc/self/exe").parent_path() / "check";
  words.insert(words.begin(), check);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawnattr_t own_group;  // roslaunch ends the group of each node
  ::posix_spawnattr_init(&own_group);
  ::posix_spawnattr_setflags(&own_group, POSIX_SPAWN_SETPGROUP);
  pid_t process = 0;
  if (::posix_spawn(&process, check.c_str(), nullptr, &own_group, arguments.data(), environ) != 0) process = 0;
  ::posix_spawnattr_destroy(&own_group);
  return process;
}

// Waits until the monitor has written its results and ended, for less than the 15 s that roslaunch leaves this node.
void wait_for_monitor(const platoon::RunOptions& run) {
  for (int i = 0; i < 100; ++i) {
    try {
      platoon::lock_output(run);
      return;
    } catch (const platoon::ConfigurationError&) {
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
  }
}

// Prints the result when roslaunch has ended: as the last line on the screen. Process 1, as of a container, takes all
// others with it: the result is then printed before it ends.
void print_result_after(long roslaunch, const platoon::RunOptions& run) {
  if (roslaunch != 1) {
    start_check({run.output, "--after", std::to_string(roslaunch)});
    return;
  }
  wait_for_monitor(run);
  if (const pid_t check = start_check({run.output}); check > 0) ::waitpid(check, nullptr, 0);
}

void run_until_complete(ros::NodeHandle platoon, const platoon::Configuration& configuration,
                        platoon::Superseded& superseded) {
  Finished finished(platoon, configuration, superseded.join());
  const ros::Subscriber progress = platoon.subscribe(platoon::kProgressTopic, 100, &Finished::receive, &finished);
  superseded.spin();
  if (const long roslaunch = platoon::roslaunch_process(); !ros::ok() && roslaunch > 0)
    print_result_after(roslaunch, configuration.run);
}

}  // namespace

int until_complete_main(int argc, char** argv) {
  return platoon::run_component(
      argc, argv,
      {"until_complete",
       "Ends its launch when the run is complete (_stay:=true: leaves it up), and prints the result when the launch has ended.\n"
       "platoon.launch starts it.\nExample: rosrun stochastic_platoon until_complete __ns:=platoon"},
      run_until_complete);
}
