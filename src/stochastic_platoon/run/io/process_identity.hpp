#pragma once

#include <sys/types.h>

#include <optional>
#include <string>

namespace platoon {

/// A process by its number, its start and the kernel that it runs on: numbers are used again, and another machine has
/// its own.
struct ProcessIdentity {
  pid_t number = 0;
  unsigned long long start = 0;  ///< clock ticks since the kernel's start
  std::string kernel;            ///< of this boot, with its space of process numbers; without spaces
};

/// The boot of this machine and this process's space of process numbers.
std::string present_kernel();

/// None where there is no such process.
std::optional<ProcessIdentity> process_identity(pid_t number);

/// Whether it is there still. One of another kernel is not.
bool lives(const ProcessIdentity& process);

/// Seconds since this machine was started, asleep or not: no clock that anybody sets.
double seconds_since_boot();

}  // namespace platoon
