#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/math/model/platoon_model.hpp"

namespace platoon {

/// The figures of the theory of the tracking errors or of a signal that come from independent computations.
struct TheoryFigures {
  const std::vector<double>& stationary_variance;  ///< P_1, ..., P_N, by spectra
  const std::vector<double>& variance;             ///< one per follower and step (see cell()), by steps; empty: unknown
  std::optional<double> limit_variance;            ///< of a string stable platoon
  std::string signal = "";                         ///< its name; empty: the tracking error
};

/// Number of followers, the first of N, whose variances have settled at the last of K steps: twice the settling_steps()
/// have passed since the start and, if packets are lost, since the leader changed its speed.
std::size_t settled_followers(const PlatoonModel& model, std::size_t followers, std::int64_t steps);

/// A sentence for each pair of figures that must agree and do not; empty if all agree:
///
/// - the variance of the last of K steps and P_i, for each follower that has settled, to 1e-4;
/// - P_i and P_{i+M}, M the length of the pattern: each vehicle adds to the spectrum, so that P_{i+M} >= P_i;
/// - P_i and the limit of a string stable platoon, which is the supremum of all P_i.
std::vector<std::string> contradictions(const PlatoonModel& model, const std::vector<TheoryFigures>& figures,
                                        std::int64_t steps);

}  // namespace platoon
