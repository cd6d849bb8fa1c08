#pragma once

#include <cstddef>

namespace platoon {

/// Assigns the vehicles of a string to the threads of one process.
///
/// The string is divided into short segments: vehicles, the channels into them, and the monitor's work on their
/// positions. Most messages then stay in the caches of one core, and a batch that passes through a long string keeps
/// all threads busy. Segments go to the threads in ascending, then in descending order, and so on, because a batch
/// arrives at the end of the string later and ends there earlier.
class Segments {
public:
  /// followers >= 1, threads >= 1. Uses no more threads than followers.
  Segments(std::size_t followers, std::size_t threads);

  std::size_t threads() const { return threads_; }

  /// The thread 0 .. threads - 1 of vehicle 0 .. followers. The leader is on thread 0.
  std::size_t thread_of(std::size_t vehicle) const;

private:
  std::size_t threads_;
  std::size_t length_;  ///< vehicles in a segment
};

}  // namespace platoon
