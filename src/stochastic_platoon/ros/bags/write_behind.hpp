#pragma once

#include <cstdint>
#include <string>

namespace platoon {

/// Makes a growing file cheaper to write: preallocates blocks, starts write-back early, drops written pages
/// from the cache. A recording of many gigabytes neither fills the memory nor waits for a sync at its end. All
/// of it is advice to the kernel: a file system that ignores it is only slower.
class WriteBehind {
public:
  WriteBehind() = default;
  /// Opens the file beside its writer. Throws std::runtime_error when it cannot.
  explicit WriteBehind(const std::string& file);
  ~WriteBehind();
  WriteBehind(WriteBehind&& other) noexcept;
  WriteBehind& operator=(WriteBehind&& other) noexcept;

  /// The writer has come to this length; it may still change the last kTail bytes.
  void advance(std::uint64_t length);

  /// The writer has ended: gives back the blocks beyond the file's end.
  void finish();

  /// Sends what others still write to the same file, by descriptors of this process, to nowhere.
  void divert_others();

private:
  static constexpr std::uint64_t kSpan = 4u << 20;       ///< bytes sent to the disk at once
  static constexpr std::uint64_t kOnTheWay = 16u << 20;  ///< bytes that may be on their way to the disk
  static constexpr std::uint64_t kTail = 2u << 20;
  static constexpr std::uint64_t kAhead = 256u << 20;  ///< bytes whose blocks are found at once

  int descriptor_ = -1;
  std::uint64_t reserved_ = 0;  ///< bytes that have their blocks
  std::uint64_t sent_ = 0;      ///< bytes on their way to the disk, or there
  std::uint64_t released_ = 0;  ///< bytes there, and out of the page cache
};

}  // namespace platoon
