#include "stochastic_platoon/ros/hosting/run_component.hpp"

#include <fcntl.h>
#include <malloc.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <ros/xmlrpc_manager.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "stochastic_platoon/ros/transport/kept_topics.hpp"
#include "stochastic_platoon/ros/transport/publishers.hpp"
#include "stochastic_platoon/run/configuration/version.hpp"
#include "stochastic_platoon/run/io/printable.hpp"
#include "stochastic_platoon/run/results/checkpoint.hpp"
#include "stochastic_platoon/run/results/provenance.hpp"

namespace platoon {

namespace {

// Whether process 1 launches nodes, as in a container: roslaunch, rostest, or a program of one's own with roslaunch's
// API, all in Python. Otherwise it is an init, which adopts the nodes of a launcher that has ended.
bool is_process_1_a_launcher() {
  std::ifstream stream("/proc/1/cmdline", std::ios::binary);
  std::string program;
  std::getline(stream, program, '\0');
  return std::filesystem::path(program).filename().string().rfind("python", 0) == 0;
}

// Ends the node when its parent ends. A killed roslaunch does not stop its nodes: they would keep running and collide
// with the next launch on the same master. The launch files set this variable; a node started by hand may outlive its
// shell.
void end_with_launch() {
  if (std::getenv(kEndsWithLaunch) == nullptr) return;
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  // It has ended already, unless it is process 1.
  if (::getppid() == 1 && !is_process_1_a_launcher()) ::raise(SIGTERM);
}

// Executes the program again if the node got the address of its killed predecessor, which happens about once in ten
// thousand starts. Other nodes identify the killed node by its address and would never connect to a new node at that
// address.
void require_other_address(const std::string& before, const std::vector<char*>& arguments) {
  if (before.empty() || before != ros::XMLRPCManager::instance()->getServerURI()) return;
  ROS_INFO_STREAM(ros::this_node::getName()
                  << ": got the address of its killed predecessor: starting again at another one");
  ros::shutdown();  // a connection that its threads accept now would stay open, unanswered, in the new program
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    const int file = std::stoi(entry.path().filename());
    if (file > 2) ::fcntl(file, F_SETFD, FD_CLOEXEC);
  }
  ::execv("/proc/self/exe", arguments.data());
  throw std::runtime_error("cannot be started again");
}

// Answers arguments other than roscpp's name:=value. Returns the exit status; none if there are no others.
std::optional<int> answered(int argc, char** argv, const NodeTraits& traits) {
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--help" || argument == "-h") {
      std::printf("rosrun stochastic_platoon %s [--help | --version | name:=value ...]\n%s\n", traits.name,
                  traits.purpose);
      return 0;
    }
    if (argument == "--version") {
      std::printf("stochastic_platoon %s\n", kVersion);
      return 0;
    }
    if (argument.find(":=") != std::string::npos) continue;
    std::fprintf(stderr,
                 "%s: %s: unknown argument: must be name:=value (_name:=value for a parameter), --help or --version\n",
                 traits.name, printable(argument).c_str());
    return 2;
  }
  return std::nullopt;
}

}  // namespace

int run_node(int argc, char** argv, const NodeTraits& traits, const std::function<void(const ros::NodeHandle&)>& run) {
  if (const std::optional<int> status = answered(argc, argv, traits)) return *status;
  if (traits.arenas > 0) mallopt(M_ARENA_MAX, traits.arenas);
  std::vector<char*> arguments(argv, argv + argc);  // before roscpp removes its own
  arguments.push_back(nullptr);
  ros::init(argc, argv, traits.name, traits.init_options);
  end_with_launch();
  const std::string address_before = address_of(ros::this_node::getName());
  // Outside the try block: keeps ROS, and with it the console, alive until the error is logged.
  const ros::NodeHandle platoon;
  const KeptTopics topics;
  try {
    require_other_address(address_before, arguments);
    run(platoon);
    return 0;
  } catch (const std::exception& error) {
    ROS_FATAL_STREAM(ros::this_node::getName() << ": " << error.what());
    return 1;
  }
}

void end_launch() {
  const long roslaunch = std::getenv(kEndsWithLaunch) != nullptr ? roslaunch_process() : 0;
  if (roslaunch == 0 || ::kill(static_cast<pid_t>(roslaunch), SIGINT) != 0) ros::shutdown();
}

// Not ros::spin(): while ROS shuts down, the global queue no longer waits for callbacks, and its busy loop would cost a
// hundred vehicles seconds of CPU time.
void Superseded::spin() const {
  while (ros::ok() && !happened_) {
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.1));
    if (ros::isShuttingDown()) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

int run_component(int argc, char** argv, const NodeTraits& traits,
                  const std::function<void(const ros::NodeHandle&, const Configuration&, Superseded&)>& run) {
  return run_node(argc, argv, traits, [&run](const ros::NodeHandle& platoon) {
    while (const std::optional<Configuration> configuration = wait_for_configuration(platoon)) {
      keep_freed_memory(configuration->run, 1);
      Superseded superseded;
      run(platoon, *configuration, superseded);
      if (!ros::ok()) return;
      ROS_INFO_STREAM(ros::this_node::getName() << ": the platoon's run is another now: starting over");
    }
  });
}

void keep_freed_memory(const RunOptions& run, std::size_t vehicles) {
  const std::size_t kept = std::clamp<std::size_t>(24 * vehicles * run.batch * sizeof(double), 1 << 20, 1 << 30);
  mallopt(M_TOP_PAD, static_cast<int>(kept));
  mallopt(M_TRIM_THRESHOLD, static_cast<int>(kept + kept / 2));
  mallopt(M_MMAP_THRESHOLD, 1 << 25);  // the maximum of older versions of glibc
}

}  // namespace platoon
