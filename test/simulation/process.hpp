#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "simulation/machine.hpp"
#include "simulation/world.hpp"
#include "stochastic_platoon/ros/hosting/one_process.hpp"
#include "stochastic_platoon/ros/nodes/channel.hpp"
#include "stochastic_platoon/ros/nodes/follower.hpp"
#include "stochastic_platoon/ros/nodes/leader.hpp"
#include "stochastic_platoon/ros/nodes/monitor.hpp"
#include "stochastic_platoon/ros/nodes/recorder.hpp"
#include "stochastic_platoon/ros/replay/player.hpp"
#include "stochastic_platoon/ros/replay/vehicle_replay.hpp"

namespace platoon::simulation {

constexpr char kNamespace[] = "/platoon";

/// A node of the package in a process that roslaunch keeps alive: its main, as in src/nodes, and its ends.
class Process {
public:
  enum class Program { leader, channel, follower, monitor, platoon, player, vehicle_replay };

  /// `index`: that of a follower, also of the one that vehicle_replay drives. `kept`: one of followers.launch. `bags`:
  /// the files that a replay reads.
  Process(World& world, Machine& machine, Program program, std::uint32_t index = 0, bool kept = false,
          std::vector<std::string> bags = {});
  ~Process();

  const std::string& name() const { return name_; }
  Program program() const { return program_; }
  bool runs() const { return node_ != nullptr; }
  Node* node() const { return node_.get(); }
  /// Whether the launch ends with it.
  bool is_required() const { return program_ == Program::player || program_ == Program::vehicle_replay; }
  bool has_monitor() const { return monitor_ || platoon_; }
  const VehicleReplay* replay() const { return vehicle_replay_.get(); }

  void start();
  void stop();  ///< SIGTERM
  void kill();  ///< SIGKILL
  /// After the respawn delay and the time that a program needs to start. `is_due`: whether its launch still runs.
  void start_again(std::function<bool()> is_due);
  /// As main() returns with an error.
  void fail();

private:
  void construct();
  void destroy();
  RunMembership::Join superseded();

  World& world_;
  Machine& machine_;
  Program program_;
  std::uint32_t index_;
  bool kept_;
  std::vector<std::string> bags_;
  std::string name_;
  std::unique_ptr<Node> node_;
  std::vector<std::string> files_;  ///< beginnings of their names
  std::unique_ptr<Leader> leader_;
  std::unique_ptr<Recorder> recorder_;
  std::unique_ptr<Channel> channel_;
  std::unique_ptr<Follower> follower_;
  std::unique_ptr<Monitor> monitor_;
  std::unique_ptr<OneProcess> platoon_;
  std::unique_ptr<Player> player_;
  std::unique_ptr<VehicleReplay> vehicle_replay_;
};

}  // namespace platoon::simulation
