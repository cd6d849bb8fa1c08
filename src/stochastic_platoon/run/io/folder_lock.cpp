#include "stochastic_platoon/run/io/folder_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <ctime>
#include <limits>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/run/io/printable.hpp"
#include "stochastic_platoon/run/io/process_identity.hpp"

namespace platoon {

namespace {

// Content of the file: the holder's name on the first line, then its process, its guardian and the end of its claim.
struct Entry {
  std::string holder;
  std::optional<ProcessIdentity> process, guardian;
  double until = std::numeric_limits<double>::infinity();  ///< [s] since the start of the machine
};

constexpr char kNobody[] = "-";

std::string text_of(const std::optional<ProcessIdentity>& process) {
  if (!process) return kNobody;
  return std::to_string(process->number) + " " + std::to_string(process->start) + " " + process->kernel;
}

std::optional<ProcessIdentity> read_process(std::istream& words) {
  std::string number;
  ProcessIdentity process;
  if (!(words >> number) || number == kNobody) return std::nullopt;
  std::istringstream(number) >> process.number;
  words >> process.start >> process.kernel;
  return process;
}

// Empty if it is not whole: the machine ended before it was on the disk, and its holder with it.
Entry entry_in(int descriptor) {
  char text[1000];
  const ssize_t length = ::pread(descriptor, text, sizeof text, 0);
  const std::string content = length > 0 ? std::string(text, static_cast<std::size_t>(length)) : "";
  const bool is_whole = std::count(content.begin(), content.end(), '\n') >= 3 && content.back() == '\n' &&
                        content.find('\0') == std::string::npos;
  if (!is_whole) return {};
  std::istringstream stream(content);
  Entry entry;
  std::getline(stream, entry.holder);
  entry.holder = printable(entry.holder);
  entry.process = read_process(stream);
  entry.guardian = read_process(stream);
  double until = 0.0;
  if (stream >> until) entry.until = until;
  return entry;
}

// [s] since the file was written, by the clock of its file system, read from a new file there.
double age_of(int descriptor, const std::string& file) {
  const std::string probe = file + "." + std::to_string(::getpid());
  const int made = ::open(probe.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  struct stat then {
  }, now{};
  const bool known = made >= 0 && ::fstat(made, &now) == 0 && ::fstat(descriptor, &then) == 0;
  if (made >= 0) {
    ::close(made);
    ::unlink(probe.c_str());
  }
  return known ? std::difftime(now.st_mtime, then.st_mtime) : std::numeric_limits<double>::infinity();
}

// Reason why the name of an ended process excludes other holders; empty if it does not.
std::string claim_of(const Entry& entry, int descriptor, const std::string& file) {
  const bool of_this_machine = entry.process && entry.process->kernel == present_kernel();
  if (!of_this_machine) {
    const double left = FolderLock::kClaimSeconds - age_of(descriptor, file);
    if (!(left > 0.0 && left <= FolderLock::kClaimSeconds)) return "";  // a time in the future is not a valid age
    return formatted(" on another machine; it is free in %.0f s unless that comes back", std::ceil(left));
  }
  if (!entry.guardian || !lives(*entry.guardian)) return "";
  const double left = entry.until - seconds_since_boot();
  if (!(left > 0.0)) return "";
  const std::string ends = formatted("when process %ld ends", static_cast<long>(entry.guardian->number));
  if (std::isinf(left)) return ", which starts it again; it is free " + ends;
  return formatted("; it is free in %.0f s unless that takes it, or ", std::ceil(left)) + ends;
}

}  // namespace

FolderLock::FolderLock(const std::string& folder, const std::string& holder, pid_t guardian)
    : file_(folder + "/.lock"),
      holder_(holder),
      descriptor_(::open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)) {
  if (descriptor_ < 0)
    throw std::runtime_error(file_ + ": cannot be opened: " + std::generic_category().message(errno));
  const auto reject = [this](const std::string& why) {
    ::close(descriptor_);
    throw std::runtime_error(why);
  };
  const bool free = ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0;
  if (!free && errno != EWOULDBLOCK) reject(file_ + ": cannot be locked: " + std::generic_category().message(errno));
  const Entry entry = entry_in(descriptor_);
  const std::string in_use = folder + ": is in use by " + (entry.holder.empty() ? "another process" : entry.holder);
  if (!free) {
    const bool here = entry.process && lives(*entry.process);
    reject(in_use + (here ? formatted("; it is free when process %ld ends", static_cast<long>(entry.process->number))
                          : std::string("; it is free when that ends")));
  }
  if (!entry.holder.empty() && entry.holder != holder) {
    const std::string claim = claim_of(entry, descriptor_, file_);
    if (!claim.empty()) reject(in_use + claim);
  }
  if (!write(guardian, std::numeric_limits<double>::infinity()))
    reject(file_ + ": cannot be written: " + std::generic_category().message(errno));
}

bool FolderLock::write(pid_t guardian, double until) {
  std::string text = holder_ + "\n" + text_of(process_identity(::getpid())) + "\n" +
                     text_of(guardian > 0 ? process_identity(guardian) : std::nullopt) + "\n";
  if (!std::isinf(until)) text += formatted("%.1f\n", until);
  return ::ftruncate(descriptor_, 0) == 0 &&
         ::pwrite(descriptor_, text.data(), text.size(), 0) == static_cast<ssize_t>(text.size());
}

void FolderLock::leave_claim(pid_t guardian) {
  claim_ = write(guardian, seconds_since_boot() + kClaimSeconds);
}

FolderLock::~FolderLock() {
  if (!claim_ && ::ftruncate(descriptor_, 0) != 0) {
    // The name stays in the file and excludes others no longer than that of a killed process.
  }
  ::close(descriptor_);
}

}  // namespace platoon
