#pragma once

#include <cstddef>

namespace platoon {

/// Which thread computes which vehicle of a string in one process.
///
/// The string is cut into short segments: vehicles, the channels into them, and what the monitor does of their
/// positions. So most messages stay in one core's caches, and a batch on its way through a long string still
/// keeps all threads busy. They are dealt out there and back, because a batch reaches the end of the string
/// later and is over there earlier.
class Segments {
public:
  /// followers >= 1, threads >= 1. Uses no more threads than followers.
  Segments(std::size_t followers, std::size_t threads);

  std::size_t threads() const { return threads_; }

  /// 0 .. threads - 1, of vehicle 0 .. followers. The leader is on the first thread.
  std::size_t thread_of(std::size_t vehicle) const;

private:
  std::size_t threads_;
  std::size_t length_;  ///< vehicles in a segment
};

}  // namespace platoon
