#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "stochastic_platoon/math/model/platoon_model.hpp"

namespace platoon {

/// Mean and variance of one signal at every (i, k), i = 1 .. followers, k = 0 .. steps - 1, in the units of the signal;
/// the index of follower i at step k is (i-1) steps + k.
struct SignalMoments {
  std::vector<double> mean, variance;
  std::vector<double> covariance_with_previous;  ///< of s(k-1) and s(k), at k = 0 of s(-1) and s(0); only of the gap
};

/// Exact moments of the signals of these names (see signal_kinds()), from the first step on, in the order of the names.
///
/// About their means the positions respond to white noises on every link, present from step 0 on, and to the initial
/// positions. With f_ij the response of s_i to source j of variance v_j, variance and covariance with the step before
/// are
/// \f[ \sum_j v_j \sum_{l \le k} f_{ij}(l)^2, \qquad \sum_j v_j \sum_{l \le k} f_{ij}(l-1) f_{ij}(l) \f]
/// for noises, f_ij(-1) = 0, and the last term of each sum alone for initial positions. A source farther back than the
/// farthest vehicle heard has the responses of the same place one pattern before: O(followers steps) time per vehicle
/// of the pattern. If any vehicle hears others than its predecessor, the means are simulated without noise.
/// 1e-11 relative; for a mean relative to the positions times the signal's factor.
///
/// Throws std::invalid_argument unless followers >= 1, steps >= 1 and has_normal_errors(model), for an unknown name,
/// and if a loop has no equilibrium.
std::vector<SignalMoments> signal_moments(const PlatoonModel& model, const std::vector<std::string>& names,
                                          std::size_t followers, std::int64_t steps);

/// The same of the tracking errors of a string whose vehicles hear any vehicles ahead. Links may quantise. Throws
/// std::invalid_argument unless followers >= 1 and steps >= 1, and for links that lose.
SignalMoments hearing_error_moments(const PlatoonModel& model, std::size_t followers, std::int64_t steps);

}  // namespace platoon
