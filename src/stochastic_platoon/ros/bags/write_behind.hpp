#pragma once

#include <cstdint>
#include <string>

namespace platoon {

/// Makes a growing file cheaper to write: preallocates blocks, starts write-back early, drops written pages
/// from the cache. A recording of many gigabytes neither fills the memory nor waits for a sync at its end. All
/// of it is advice to the kernel: a file system that ignores it is only slower.
class WriteBehind {
public:
  /// Opens the file in addition to its writer. Throws std::runtime_error if this fails.
  explicit WriteBehind(const std::string& file);
  ~WriteBehind();
  WriteBehind(const WriteBehind&) = delete;
  WriteBehind& operator=(const WriteBehind&) = delete;

  /// The file has grown to `length` bytes; the writer may still change the last kTail bytes.
  void advance(std::uint64_t length);

  /// Releases the blocks beyond the end of the file, after the writer has closed it.
  void finish();

  /// Redirects all other descriptors of this process for the same file to /dev/null.
  void divert_others();

private:
  static constexpr std::uint64_t kSpan = 4u << 20;       ///< bytes sent to the disk at once
  static constexpr std::uint64_t kOnTheWay = 16u << 20;  ///< bytes that may be on their way to the disk
  static constexpr std::uint64_t kTail = 2u << 20;
  static constexpr std::uint64_t kAhead = 256u << 20;  ///< bytes preallocated at once

  int descriptor_;
  std::uint64_t reserved_ = 0;  ///< bytes preallocated
  std::uint64_t sent_ = 0;      ///< bytes whose write-back has started
  std::uint64_t released_ = 0;  ///< bytes on the disk and out of the page cache
};

}  // namespace platoon
