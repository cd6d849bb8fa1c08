#include "stochastic_platoon/ros/bags/write_behind.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

namespace platoon {

WriteBehind::WriteBehind(const std::string& file) : descriptor_(::open(file.c_str(), O_RDWR | O_CLOEXEC)) {
  if (descriptor_ < 0) {
    throw std::runtime_error(file + ": cannot be opened: " + std::generic_category().message(errno));
  }
}

WriteBehind::~WriteBehind() {
  ::close(descriptor_);
}

void WriteBehind::advance(std::uint64_t length) {
  if (length < sent_ + kSpan + kTail) return;
  if (length + kAhead / 2 > reserved_) {
    ::fallocate(descriptor_, FALLOC_FL_KEEP_SIZE, static_cast<off64_t>(length), kAhead);
    reserved_ = length + kAhead;
  }
  const std::uint64_t ready = length - kTail;
  ::sync_file_range(descriptor_, static_cast<off64_t>(sent_), static_cast<off64_t>(ready - sent_),
                    SYNC_FILE_RANGE_WRITE);
  sent_ = ready;
  while (sent_ - released_ > kOnTheWay) {
    const auto begin = static_cast<off64_t>(released_);
    ::sync_file_range(descriptor_, begin, kSpan,
                      SYNC_FILE_RANGE_WAIT_BEFORE | SYNC_FILE_RANGE_WRITE | SYNC_FILE_RANGE_WAIT_AFTER);
    ::posix_fadvise(descriptor_, begin, kSpan, POSIX_FADV_DONTNEED);
    released_ += kSpan;
  }
}

void WriteBehind::divert_others() {
  struct stat own;
  if (::fstat(descriptor_, &own) != 0) return;
  const int nowhere = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  if (nowhere < 0) return;
  std::vector<int> open;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd"))
    open.push_back(std::stoi(entry.path().filename().string()));
  for (const int descriptor : open) {
    struct stat status;
    if (descriptor == descriptor_ || ::fstat(descriptor, &status) != 0) continue;
    if (status.st_dev == own.st_dev && status.st_ino == own.st_ino) ::dup3(nowhere, descriptor, O_CLOEXEC);
  }
  ::close(nowhere);
}

void WriteBehind::finish() {
  struct stat status;
  if (reserved_ == 0 || ::fstat(descriptor_, &status) != 0) return;
  // Changes no byte of the file; if it fails, only the blocks stay reserved.
  if (::ftruncate(descriptor_, status.st_size) == 0) reserved_ = 0;
}

}  // namespace platoon
