#pragma once

#include <functional>
#include <vector>

namespace platoon {

/// A quantity over which stability is searched, and a margin that is positive just where it is stable.
using StabilityMargin = std::function<double(double)>;

struct StableInterval {
  double from;
  double to;
};

/// Where the margin is positive, in ascending order, between the first and the last of the places, which ascend: there
/// it is sampled. It is followed to its extremes where it turns near zero between samples without changing sign,
/// and every change of sign is found to 1e-13 relative. A stretch is missed only if the margin turns more than
/// once between two samples.
std::vector<StableInterval> stable_intervals(const StabilityMargin& margin, const std::vector<double>& places);

}  // namespace platoon
