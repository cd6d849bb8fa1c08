#pragma once

#include <sys/types.h>

#include <string>

namespace platoon {

/// Keeps a folder for one holder: flock(2) on the file `.lock` in it, which names the holder. It is released when
/// this object or its process ends, however that ends.
///
/// Behind a process that was killed its name may keep others out while another process lives: the guardian that starts
/// it again (roslaunch, for its monitor), known by its number and its start. A holder may also claim the folder before
/// the process that will hold it is there: a claim ends with its guardian, too, and after kClaimSeconds at the latest.
/// No clock of the day counts, only the time since the machine was started. What another machine has left in a shared
/// folder keeps others out for kClaimSeconds by the clock of the file system; while its process lives, flock does.
class FolderLock {
public:
  static constexpr double kClaimSeconds = 30.0;

  /// Takes the folder, which must exist. `guardian`: 0 is none. Throws std::runtime_error when it is another's, naming
  /// the holder and how long to wait.
  FolderLock(const std::string& folder, const std::string& holder, pid_t guardian = 0);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

  /// Ends it, but keeps others out for a while, as long as the guardian lives: a process that comes with this holder's
  /// name takes it.
  void leave_claim(pid_t guardian);

private:
  bool write(pid_t guardian, double until);

  std::string file_, holder_;
  int descriptor_;
  bool claim_ = false;
};

}  // namespace platoon
