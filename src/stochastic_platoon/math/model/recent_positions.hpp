#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/numerics/aligned_values.hpp"

namespace platoon {

/// The three latest positions of a vehicle for a batch of realizations, from which the differences that inputs carry
/// follow.
class RecentPositions {
public:
  /// Step -1, before which the vehicle moved by `slope` per step (start_slope()) [m].
  void start(const double* positions, std::size_t count, double slope) {
    for (std::size_t back = 0; back < latest_.size(); ++back) {
      latest_[back].assign(positions, positions + count);
      for (double& position : latest_[back]) position = position_before(position, back, slope);
    }
  }

  /// The next step. The vehicle moves on for as many realizations as it started with.
  void add(const double* positions) {
    std::swap(latest_[2], latest_[1]);
    std::swap(latest_[1], latest_[0]);
    std::copy_n(positions, latest_[0].size(), latest_[0].begin());
  }

  std::size_t count() const { return latest_[0].size(); }

  /// y(k), y(k-1), y(k-2).
  Signal::Recent<const double*> all() const { return {latest_[0].data(), latest_[1].data(), latest_[2].data()}; }

private:
  std::array<AlignedValues, 3> latest_ = {};
};

}  // namespace platoon
