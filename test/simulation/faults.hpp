#pragma once

#include <ros/serialized_message.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "simulation/world.hpp"

namespace platoon::simulation {

enum class FaultKind {
  kill,       ///< SIGKILL of a node
  stop,       ///< SIGTERM of a node
  pause,      ///< SIGSTOP of a node, SIGCONT later
  cut,        ///< a connection breaks, with all that is on its way
  slow,       ///< a connection is slow for a while
  full_disk,  ///< for a while
  set_clock,  ///< the wall clock jumps
  stray,      ///< a stranger publishes messages of another run
  tamper,     ///< an external vehicle breaks a clause of the contract
  order,      ///< an order to the platoon; the monitor may be killed just after it has confirmed it
  interrupt,  ///< Ctrl-C, and a launch that resumes
  power       ///< all nodes are killed, the disk loses what was not synced; a launch resumes
};

/// A fault, `wait` [s] after the one before it. `which` and `extent` choose its target and its length.
struct Fault {
  FaultKind kind;
  double wait;
  std::uint32_t which;
  double extent;  ///< 0 to 1
};

std::string to_string(const Fault& fault);

/// Launches of one platoon, one after another, with followers that may outlive them, under faults.
struct Plan {
  std::uint64_t seed;
  std::vector<Fault> faults;
};

/// The plan of a seed.
Plan plan_of(std::uint64_t seed);

/// Cuts a connection, or slows it down for a while. Returns which.
std::string disturb_connection(World& world, const Fault& fault);

/// Limits the size of files for a while.
void fill_disk(World& world, const Fault& fault);

/// A position as a vehicle sends it that breaks its contract, in one of five ways; none if it sends nothing.
std::optional<ros::SerializedMessage> tampered(const ros::SerializedMessage& position, std::uint32_t which);

}  // namespace platoon::simulation
