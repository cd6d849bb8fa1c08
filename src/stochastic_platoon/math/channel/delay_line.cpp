#include "stochastic_platoon/math/channel/delay_line.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace platoon {

DelayLine::DelayLine(std::int64_t steps) {
  if (steps < 1) throw std::invalid_argument("delay: " + std::to_string(steps) + ": must be >= 1 here");
  registers_.resize(static_cast<std::size_t>(steps));
}

void DelayLine::start(std::uint64_t, std::size_t count, double* positions, double slope) {
  oldest_ = 0;
  for (std::size_t j = registers_.size(); j-- > 0;) {  // from the position of step -1 back
    registers_[j].assign(positions, positions + count);
    if (slope == 0.0) continue;
    for (std::size_t r = 0; r < count; ++r) positions[r] -= slope;
  }
}

void DelayLine::step(std::int64_t, std::uint64_t, std::size_t count, double* positions) {
  std::swap_ranges(positions, positions + count, registers_[oldest_].begin());
  oldest_ = (oldest_ + 1) % registers_.size();
}

}  // namespace platoon
