#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace platoon::simulation {

/// Clock and disk of the simulated machine. Files are real ones, below the working folder; in a simulation the
/// functions of the C library that read clocks and write files act as this object says, see machine.cpp.
class Machine {
public:
  Machine();
  ~Machine();
  Machine(const Machine&) = delete;
  Machine& operator=(const Machine&) = delete;

  /// Sets the wall clock off by a number of seconds. No program may notice.
  void set_clock(double offset) { clock_offset_ = offset; }

  /// No file can grow beyond this size; 0: any can.
  static void limit_files(std::size_t bytes);

  /// Ends a process as SIGKILL does: `destroy`, which runs its destructors, cannot write any more. `files`: the
  /// beginnings of the names of its open files, absolute.
  void kill(const std::vector<std::string>& files, const std::function<void()>& destroy);

  /// Loses what was not synced: each file below the folder keeps its synced content and, by `chance` (a number from 0
  /// to 1 at each call), a part of the rest, a page of which may be zero.
  void lose_power(const std::string& folder, const std::function<double()>& chance);

  static Machine* present();

  double clock_offset() const { return clock_offset_; }
  bool is_killing() const { return killing_; }
  void synced(int descriptor);
  void renamed(const std::string& from, const std::string& to);
  void removed(const std::string& name);

private:
  double clock_offset_ = 0.0;
  bool killing_ = false;
  std::map<std::string, std::string> synced_;  ///< contents by absolute name
};

}  // namespace platoon::simulation
