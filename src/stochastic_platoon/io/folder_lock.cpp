#include "stochastic_platoon/io/folder_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <ctime>
#include <stdexcept>
#include <system_error>

namespace platoon {

namespace {

std::string name_in(int descriptor) {
  char text[200];
  const ssize_t length = ::pread(descriptor, text, sizeof text, 0);
  return length > 0 ? std::string(text, static_cast<std::size_t>(length)) : "";
}

// Whether the name in the file is that of a claim that still holds.
bool is_fresh(int descriptor) {
  struct stat status {};
  return ::fstat(descriptor, &status) == 0 &&
         std::difftime(std::time(nullptr), status.st_mtime) < FolderLock::kClaimSeconds;
}

}  // namespace

FolderLock::FolderLock(const std::string& folder, const std::string& holder)
    : file_(folder + "/.lock"), descriptor_(::open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)) {
  if (descriptor_ < 0)
    throw std::runtime_error(file_ + ": cannot be opened: " + std::generic_category().message(errno));
  const bool free = ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0;
  if (!free && errno != EWOULDBLOCK) {
    const int reason = errno;
    ::close(descriptor_);
    throw std::runtime_error(file_ + ": cannot be locked: " + std::generic_category().message(reason));
  }
  const std::string named = name_in(descriptor_);
  if (!free || (!named.empty() && named != holder && is_fresh(descriptor_))) {
    ::close(descriptor_);
    throw std::runtime_error(folder + ": is in use by " + (named.empty() ? "another process" : named));
  }
  if (::ftruncate(descriptor_, 0) != 0 || ::pwrite(descriptor_, holder.data(), holder.size(), 0) < 0) {
    const int reason = errno;
    ::close(descriptor_);
    throw std::runtime_error(file_ + ": cannot be written: " + std::generic_category().message(reason));
  }
}

FolderLock::~FolderLock() {
  if (!claim_ && ::ftruncate(descriptor_, 0) != 0) {
    // The name stays: it keeps others out for kClaimSeconds more, and nothing else.
  }
  ::close(descriptor_);
}

}  // namespace platoon
