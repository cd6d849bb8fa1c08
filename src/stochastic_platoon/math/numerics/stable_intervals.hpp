#pragma once

#include <functional>
#include <vector>

namespace platoon {

/// Stability margin as a function of the varied quantity, positive exactly if the system is stable.
using StabilityMargin = std::function<double(double)>;

struct StableInterval {
  double from;
  double to;
};

/// The intervals between the first and the last of `places` (ascending) in which the margin is positive, in ascending
/// order and with ends to this relative accuracy. The margin is sampled at `places`; if it turns near zero between
/// samples without changing sign, the search follows it to its extreme. A stretch is missed only if the margin turns
/// more than once between two samples.
///
/// `necessary`, if given, is a margin that is cheaper to compute; a place is then stable if both are positive there,
/// and `margin` is evaluated only where `necessary` is positive. The search for each end starts where `necessary`
/// changes sign.
std::vector<StableInterval> stable_intervals(const StabilityMargin& margin, const std::vector<double>& places,
                                             const StabilityMargin& necessary = {}, double accuracy = 1e-12);

}  // namespace platoon
