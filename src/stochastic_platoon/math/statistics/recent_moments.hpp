#pragma once

#include <cstdint>
#include <utility>

#include "stochastic_platoon/math/statistics/moments.hpp"

namespace platoon {

/// Moments of the latest values of a growing sequence, of at least half of them: its beginning is forgotten, in bounded
/// memory. The sequence is cut into blocks of 1, 2, 4, ... values; the present block and the one before it count.
class RecentMoments {
public:
  void add(double value) {
    present_.add(value);
    if (present_.count < size_) return;
    before_ = std::exchange(present_, Moments{});
    size_ *= 2;
  }

  Moments moments() const { return merge(before_, present_); }

private:
  std::uint64_t size_ = 1;  ///< of the present block, when it is full
  Moments before_, present_;
};

}  // namespace platoon
