#pragma once

#include <sys/types.h>

#include <optional>
#include <string>

namespace platoon {

/// A process, identified by its number, its start and its kernel: numbers are reused, and each machine has its own.
struct ProcessIdentity {
  pid_t number = 0;
  unsigned long long start = 0;  ///< clock ticks since boot
  std::string kernel;            ///< boot and process number namespace; without spaces
};

/// The boot of this machine and the process number namespace of this process.
std::string present_kernel();

/// None if there is no such process.
std::optional<ProcessIdentity> process_identity(pid_t number);

/// Whether the process still runs; false for a process of another kernel.
bool lives(const ProcessIdentity& process);

/// Seconds since this machine was booted, including suspend; independent of the wall clock.
double seconds_since_boot();

}  // namespace platoon
