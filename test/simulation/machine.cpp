#include "simulation/machine.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/statvfs.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "simulation/world.hpp"

namespace platoon::simulation {

namespace {

namespace fs = std::filesystem;

Machine* the_machine = nullptr;

std::string content_of(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::string name_of(int descriptor) {
  std::error_code error;
  return fs::read_symlink("/proc/self/fd/" + std::to_string(descriptor), error).string();
}

std::string absolute(const std::string& name) {
  return fs::absolute(name).lexically_normal().string();
}

}  // namespace

Machine::Machine() {
  the_machine = this;
}

Machine::~Machine() {
  the_machine = nullptr;
  limit_files(0);
}

Machine* Machine::present() {
  return the_machine;
}

void Machine::limit_files(std::size_t bytes) {
  rlimit limit{};
  ::getrlimit(RLIMIT_FSIZE, &limit);
  limit.rlim_cur = bytes == 0 ? limit.rlim_max : bytes;
  ::setrlimit(RLIMIT_FSIZE, &limit);
}

void Machine::kill(const std::vector<std::string>& files, const std::function<void()>& destroy) {
  const int nowhere = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  std::vector<int> open;
  for (const auto& entry : fs::directory_iterator("/proc/self/fd")) open.push_back(std::stoi(entry.path().filename()));
  for (const int descriptor : open) {
    const std::string name = name_of(descriptor);
    const bool is_own =
        std::any_of(files.begin(), files.end(), [&name](const auto& begin) { return name.rfind(begin, 0) == 0; });
    if (is_own) ::dup3(nowhere, descriptor, O_CLOEXEC);
  }
  killing_ = true;
  destroy();
  killing_ = false;
  ::close(nowhere);
}

void Machine::lose_power(const std::string& folder, const std::function<double()>& chance) {
  constexpr std::size_t kPage = 4096;
  std::vector<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files.push_back(absolute(entry.path().string()));
  }
  std::sort(files.begin(), files.end());
  for (const std::string& file : files) {
    const auto found = synced_.find(file);
    const std::string written = content_of(file);
    std::string kept = found != synced_.end() ? found->second : "";
    if (kept == written) continue;
    if (written.compare(0, kept.size(), kept) == 0 && chance() < 0.7) {
      const std::size_t from = kept.size();
      kept += written.substr(from, static_cast<std::size_t>(chance() * static_cast<double>(written.size() - from + 1)));
      if (chance() < 0.5 && kept.size() > from) {
        const std::size_t begin = std::max(from, (kept.size() - 1) / kPage * kPage);
        std::fill(kept.begin() + static_cast<std::ptrdiff_t>(begin), kept.end(), '\0');
      }
    }
    std::ofstream(file, std::ios::binary | std::ios::trunc) << kept;
  }
}

void Machine::synced(int descriptor) {
  const std::string name = name_of(descriptor);
  if (fs::is_regular_file(name)) synced_[name] = content_of(name);
}

void Machine::renamed(const std::string& from, const std::string& to) {
  const auto found = synced_.find(absolute(from));
  const std::string content = found != synced_.end() ? found->second : "";
  if (found != synced_.end()) synced_.erase(found);
  synced_[absolute(to)] = content;
}

void Machine::removed(const std::string& name) {
  synced_.erase(absolute(name));
}

}  // namespace platoon::simulation

using platoon::simulation::Machine;
using platoon::simulation::World;

namespace {

int removed(const char* name, int flags) {
  Machine* const machine = Machine::present();
  if (machine != nullptr && machine->is_killing()) return 0;
  const int status = static_cast<int>(::syscall(SYS_unlinkat, AT_FDCWD, name, flags));
  if (status == 0 && machine != nullptr) machine->removed(name);
  return status;
}

}  // namespace

// In place of those of the C library.
extern "C" {

int clock_gettime(clockid_t clock, timespec* time) noexcept {
  const bool is_process_time = clock == CLOCK_PROCESS_CPUTIME_ID || clock == CLOCK_THREAD_CPUTIME_ID;
  if (World::present() == nullptr || is_process_time)
    return static_cast<int>(::syscall(SYS_clock_gettime, clock, time));
  constexpr double kEpoch = 1.7e9;
  double seconds = World::present()->now();
  if (clock == CLOCK_REALTIME && Machine::present() != nullptr) seconds += kEpoch + Machine::present()->clock_offset();
  time->tv_sec = static_cast<std::time_t>(seconds);
  time->tv_nsec = static_cast<long>((seconds - static_cast<double>(time->tv_sec)) * 1e9);
  return 0;
}

int fsync(int descriptor) {
  if (Machine::present() == nullptr) return static_cast<int>(::syscall(SYS_fsync, descriptor));
  if (!Machine::present()->is_killing()) Machine::present()->synced(descriptor);
  return 0;
}

int rename(const char* from, const char* to) noexcept {
  Machine* const machine = Machine::present();
  if (machine != nullptr && machine->is_killing()) return 0;
  const int status = static_cast<int>(::syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0));
  if (status == 0 && machine != nullptr) machine->renamed(from, to);
  return status;
}

int unlink(const char* name) noexcept {
  return removed(name, 0);
}

int remove(const char* name) noexcept {
  return removed(name, std::filesystem::is_directory(name) ? AT_REMOVEDIR : 0);
}

// std::filesystem::space asks it; the space of the real disk changes between two histories.
int statvfs(const char*, struct statvfs* space) noexcept {
  *space = {};
  space->f_bsize = space->f_frsize = 4096;
  space->f_blocks = space->f_bfree = space->f_bavail = 1000000;
  return 0;
}

}  // extern "C"
