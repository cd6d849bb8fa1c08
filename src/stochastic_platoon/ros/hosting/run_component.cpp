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
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

namespace platoon {

namespace {

// roslaunch takes its nodes down when it ends, but not when it is killed: then they would go on without it, and
// the next launch on the same master would run into them. The launch files ask for this; a node that is started
// by hand may outlive the shell.
void end_with_launch() {
  if (std::getenv("PLATOON_ENDS_WITH_LAUNCH") == nullptr) return;
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (::getppid() == 1) ::raise(SIGTERM);  // it has ended already
}

// Where the master has a node of this name; empty where it has none.
std::string registered_address() {
  XmlRpc::XmlRpcValue request, response, address;
  request[0] = request[1] = ros::this_node::getName();
  if (!ros::master::execute("lookupNode", request, response, address, false)) return "";
  return address;
}

// The system hands out a port again once in some ten thousand starts. Those who were connected to a node that was
// killed know it by its address: under the same one they would never connect to what is there in its place.
void require_other_address(const std::string& before, const std::vector<char*>& arguments) {
  if (before.empty() || before != ros::XMLRPCManager::instance()->getServerURI()) return;
  ROS_INFO_STREAM(ros::this_node::getName() << ": has come back at the address it had, and takes another");
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    const int file = std::stoi(entry.path().filename());
    if (file > 2) ::fcntl(file, F_SETFD, FD_CLOEXEC);
  }
  ::execv("/proc/self/exe", arguments.data());
  throw std::runtime_error("cannot be started again");
}

}  // namespace

int run_node(int argc, char** argv, const NodeTraits& traits, const std::function<void(const ros::NodeHandle&)>& run) {
  if (traits.arenas > 0) mallopt(M_ARENA_MAX, traits.arenas);
  std::vector<char*> arguments(argv, argv + argc);  // before roscpp takes its own out
  arguments.push_back(nullptr);
  ros::init(argc, argv, traits.name, traits.init_options);
  end_with_launch();
  const std::string address_before = registered_address();
  // Outside the try block: keeps ROS, and with it the console, alive until the line is out.
  const ros::NodeHandle platoon;
  try {
    require_other_address(address_before, arguments);
    run(platoon);
    return 0;
  } catch (const std::exception& error) {
    ROS_FATAL_STREAM(ros::this_node::getName() << ": " << error.what());
    return 1;
  }
}

// Not ros::spin(): while ROS shuts down, the global queue no longer waits for callbacks, and its busy loop
// would cost a hundred vehicles seconds of both cores.
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
  mallopt(M_MMAP_THRESHOLD, 1 << 25);  // the most that older versions of glibc take
}

}  // namespace platoon
