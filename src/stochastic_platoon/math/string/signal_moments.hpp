#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "stochastic_platoon/math/links/linked_moments.hpp"

namespace platoon {

/// Exact moments of the signals of these names (see signal_kinds()), from the first step on, in the order of the names.
///
/// Where no link loses, the positions respond about their means to white noises on every link, present from step 0
/// on, and to the initial positions. With f_ij the response of s_i to source j of variance v_j, variance and covariance
/// with the step before are \f[ \sum_j v_j \sum_{l \le k} f_{ij}(l)^2, \qquad \sum_j v_j \sum_{l \le k} f_{ij}(l-1)
/// f_{ij}(l) \f] for noises, f_ij(-1) = 0, and the last term of each sum alone for initial positions. A source farther
/// back than the farthest vehicle heard has the responses of the same place one pattern before: O(followers steps) time
/// per vehicle of the pattern. If any vehicle hears others than its predecessor, the means are simulated without noise.
/// 1e-11 relative; for a mean relative to the positions times the signal's factor.
///
/// Links that lose have the theory of linked_moments() or chain_moments(), with their cost: see needs_chain_moments().
///
/// Throws std::invalid_argument unless followers >= 1 and steps >= 1, for vehicles with limits and losses without
/// theory, for an unknown name, and if a loop has no equilibrium.
std::vector<SignalMoments> signal_moments(const PlatoonModel& model, const std::vector<std::string>& names,
                                          std::size_t followers, std::int64_t steps);

/// The moments of the tracking errors and of signals.
struct StringMoments {
  SignalMoments errors;
  std::vector<SignalMoments> signals;
};

/// error_moments() and signal_moments(). Where they take chain_moments(), both cost as much as one of them.
StringMoments string_moments(const PlatoonModel& model, const std::vector<std::string>& names, std::size_t followers,
                             std::int64_t steps, std::vector<double>* fourth_cumulants = nullptr);

/// Those of the tracking errors of a string whose vehicles hear any vehicles ahead. Links may quantise. Throws
/// std::invalid_argument unless followers >= 1 and steps >= 1, and for links that lose.
SignalMoments hearing_error_moments(const PlatoonModel& model, std::size_t followers, std::int64_t steps);

}  // namespace platoon
