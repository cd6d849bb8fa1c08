#pragma once

#include <algorithm>
#include <vector>

#include "stochastic_platoon/math/statistics/moment_table.hpp"
#include "unit/math/noise/draw.hpp"

namespace platoon {

constexpr std::size_t kCells = 3;

/// Values of realizations first .. first + count - 1 in a cell: a mean that is large compared with the deviation.
inline std::vector<double> sample_values(std::size_t cell, std::uint64_t first, std::size_t count) {
  std::vector<double> x = draw(1, {static_cast<std::uint32_t>(cell), 0}, first, count);
  for (double& value : x) value = 100.0 * static_cast<double>(cell) + 0.7 * value;
  return x;
}

/// The moments of these values in every cell.
inline BatchMoments sample_batch(std::uint64_t first, std::size_t count, KeptMoments kept = KeptMoments::two) {
  BatchMoments moments(first, count, kCells, kept);
  for (std::size_t c = 0; c < kCells; ++c) moments.set(c, sample_values(c, first, count).data());
  return moments;
}

/// Realizations first .. end - 1 in batches of this size.
inline MomentTable sample_table(std::uint64_t first, std::uint64_t end, std::uint64_t size,
                                KeptMoments kept = KeptMoments::two) {
  MomentTable table(kCells);
  for (; first < end; first += size) table.add(sample_batch(first, std::min(size, end - first), kept));
  return table;
}

}  // namespace platoon
