#include "stochastic_platoon/ros/hosting/segments.hpp"

#include <algorithm>

namespace platoon {

namespace {
constexpr std::size_t kLongestSegment = 5;
}

Segments::Segments(std::size_t followers, std::size_t threads)
    : threads_(std::clamp<std::size_t>(threads, 1, followers)),
      length_(std::min(kLongestSegment, (followers + 2 * threads_ - 1) / (2 * threads_))) {}

std::size_t Segments::thread_of(std::size_t vehicle) const {
  if (vehicle == 0) return 0;
  const std::size_t round = 2 * threads_;
  const std::size_t segment = (vehicle - 1) / length_ % round;
  return std::min(segment, round - 1 - segment);
}

}  // namespace platoon
