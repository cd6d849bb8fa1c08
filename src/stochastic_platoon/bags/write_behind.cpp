#include "stochastic_platoon/bags/write_behind.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace platoon {

WriteBehind::WriteBehind(const std::string& file) : descriptor_(::open(file.c_str(), O_RDONLY | O_CLOEXEC)) {
  if (descriptor_ < 0) {
    throw std::runtime_error(file + ": cannot be opened: " + std::generic_category().message(errno));
  }
}

WriteBehind::~WriteBehind() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

WriteBehind::WriteBehind(WriteBehind&& other) noexcept {
  *this = std::move(other);
}

WriteBehind& WriteBehind::operator=(WriteBehind&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(sent_, other.sent_);
  std::swap(released_, other.released_);
  return *this;
}

void WriteBehind::advance(std::uint64_t length) {
  if (descriptor_ < 0 || length < sent_ + kSpan + kTail) return;
  const std::uint64_t ready = length - kTail;
  ::sync_file_range(descriptor_, static_cast<off64_t>(sent_), static_cast<off64_t>(ready - sent_),
                    SYNC_FILE_RANGE_WRITE);
  // By now the span before has had the time of a span to arrive.
  const auto begin = static_cast<off64_t>(released_);
  const auto size = static_cast<off64_t>(sent_ - released_);
  if (size > 0) {
    ::sync_file_range(descriptor_, begin, size,
                      SYNC_FILE_RANGE_WAIT_BEFORE | SYNC_FILE_RANGE_WRITE | SYNC_FILE_RANGE_WAIT_AFTER);
    ::posix_fadvise(descriptor_, begin, size, POSIX_FADV_DONTNEED);
  }
  released_ = sent_;
  sent_ = ready;
}

}  // namespace platoon
