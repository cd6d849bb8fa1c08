#pragma once

#include <sys/types.h>

#include <string>

namespace platoon {

/// Locks a folder for one holder with flock(2) on the file `.lock` in it, which contains the holder's name. The lock
/// ends with this object or its process, even if the process is killed.
///
/// The name of a killed process still excludes other holders while its guardian lives. The guardian is the process that
/// restarts it (roslaunch, for its monitor), identified by its number and its start. A holder may also claim the folder
/// before the process that will hold it exists; a claim ends with its guardian, and after kClaimSeconds at the latest.
/// Times count from the boot of the machine, not by the wall clock. In a shared folder, an entry of another machine
/// excludes other holders for kClaimSeconds by the clock of the file system; while its process lives, flock excludes
/// them.
class FolderLock {
public:
  static constexpr double kClaimSeconds = 30.0;

  /// Locks the folder, which must exist. `guardian`: 0 for none. Throws std::runtime_error if another holder has it;
  /// the message names the holder and how long to wait.
  FolderLock(const std::string& folder, const std::string& holder, pid_t guardian = 0);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

  /// Turns the lock into a claim when this object ends: other holders are excluded for kClaimSeconds while the guardian
  /// lives; a process with this holder's name takes the folder.
  void leave_claim(pid_t guardian);

private:
  bool write(pid_t guardian, double until);

  std::string file_, holder_;
  int descriptor_;
  bool claim_ = false;
};

}  // namespace platoon
