#pragma once

#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/math/model/platoon_model.hpp"

namespace platoon {

/// Mean bursts of the losses on the links into the default vehicle and into the types that inherit it.
struct CriticalBurst {
  double from;  ///< smallest mean burst that the chains of all these links have [steps]
  double to;    ///< largest one searched
  /// The platoon is string stable for every smaller mean burst, to 1e-9 relative; none if it is unstable at `from` or
  /// stable at every sample.
  std::optional<double> critical;
  bool stable;                     ///< at `from`
  std::vector<std::string> types;  ///< types with varied links
};

/// Samples the mean burst from the smallest one to 200 steps in ratios of 1.5 at most, up to the first unstable
/// sample, and bisects there. A stretch is missed only if it lies between two samples. None if the default link loses
/// nothing or by the states of a chain, or if no vehicle of the string uses it.
std::optional<CriticalBurst> critical_mean_burst(const PlatoonModel& model);

}  // namespace platoon
