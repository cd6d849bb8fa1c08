#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "simulation/process.hpp"

namespace platoon::simulation {

/// A node of a launch.
struct Part {
  Process::Program program;
  std::uint32_t index = 0;
  std::vector<std::string> bags = {};
};

/// The launches of one platoon, one after another, and followers that may outlive them. A node that ends is started
/// again, as long as its launch is up.
class Roslaunch {
public:
  Roslaunch(World& world, Machine& machine) : world_(world), machine_(machine) {}
  ~Roslaunch();
  Roslaunch(const Roslaunch&) = delete;
  Roslaunch& operator=(const Roslaunch&) = delete;

  /// Starts followers that outlive the launches, as followers.launch does.
  void keep(std::uint32_t followers);
  /// The nodes that a launch of this run starts: those of platoon.launch and its external vehicles.
  std::vector<Part> nodes_of(const RunOptions& run) const;

  /// Starts the nodes, each a little later.
  void launch(const std::vector<Part>& parts);
  /// Ends them, by SIGTERM or by SIGKILL.
  void end(bool killed);
  /// Kills everything, with the followers that outlive launches, which come back.
  void lose_power();

  bool is_up() const { return is_up_; }
  /// Counts the launches.
  int number() const { return number_; }
  bool keeps_followers() const { return !kept_.empty(); }

  /// All nodes, those of the present launch last.
  std::vector<Process*> processes() const;
  const std::vector<std::unique_ptr<Process>>& launched() const { return launched_; }
  /// Whether the present launch is a replay, which ends with the node that reads the recording.
  bool is_replay() const;

  /// Starts a process again that has ended, unless its launch ends before.
  void respawn(Process& process);

  /// Whether its launch ends with this node.
  bool is_required(const Node& node) const;
  /// A node has ended with an error.
  void ended(const Node& node);

private:
  Process* process_of(const Node& node) const;

  World& world_;
  Machine& machine_;
  std::vector<std::unique_ptr<Process>> kept_, launched_, ended_;
  bool is_up_ = false;
  int number_ = 0;
};

}  // namespace platoon::simulation
