#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "stochastic_platoon/math/model/signal.hpp"

namespace platoon {

/// Mean and variance of a signal for followers i = 1 .. followers, k = 0 .. steps-1; the index of follower i at step k
/// is (i-1) steps + k.
struct SignalMoments {
  std::int64_t steps;
  std::size_t followers;
  std::vector<double> mean = {};
  std::vector<double> variance = {};
  /// Of s(k-1) and s(k), at k = 0 of s(-1) and s(0); only of the gap, and where all errors are normal.
  std::vector<double> covariance_with_previous = {};

  double mean_at(std::size_t follower, std::int64_t step) const { return mean[index(follower, step)]; }
  double variance_at(std::size_t follower, std::int64_t step) const { return variance[index(follower, step)]; }

private:
  std::size_t index(std::size_t follower, std::int64_t step) const {
    return (follower - 1) * static_cast<std::size_t>(steps) + static_cast<std::size_t>(step);
  }
};

/// Exact mean and variance of signals of a platoon over links with independent losses, homogeneous or patterned, from
/// the first step on, in the order of the lists. Here for the tracking errors zeta_i:
///
/// The means pass from vehicle to vehicle: e(k) = s(k) - (L r)(k), r(k) = (L r)(k) + p e(k), with r at and before step
/// -1 the position of step -1. About the means the platoon is linear and driven by white noises: g and the dither of
/// every link, and its w(k) = (theta(k) - p) e(k), uncorrelated with all others, of variance p q E e(k)^2. With g_ij,
/// f_ij the responses of zeta_i and e_i to a source of link j and variance v_j, and P_i(k) the variance of zeta_i(k),
/// \f[ P_i(k) = \sum_j \sum_{l \le k} g_{ij}(k-l)^2 v_j(l), \f]
/// \f[ E e_i(k)^2 = (E e_i(k))^2 + \sum_j \sum_{l \le k} f_{ij}(k-l)^2 v_j(l), \f]
/// link by link along the string; initial positions are sources at step -1.
///
/// The sums over l for the losses are convolutions by fast Fourier transform if its rounding leaves twelve digits of
/// the variance, and direct otherwise. O(followers^2 steps) time for the losses, O(followers steps) per vehicle of the
/// pattern for everything else. 1e-11 relative; for a mean relative to the positions.
///
/// `fourth_cumulants`, if given, receives E (zeta - E zeta)^4 - 3 variance^2 of every cell of the first signal to first
/// order, as if the w(k) were independent:
///
///     sum_j sum_{l<=k} g_ij(k-l)^4 c_j(l),   c_j = p q (1 - 3 p q) E e_j^4 - 3 (p q E e_j^2)^2 >= 0,
///
/// with E e_j^4 of a normal e_j plus the contribution of the links before, computed in the same way. This is complete
/// for rare losses; for frequent losses it omits the effect of consecutive losses.
///
/// Throws std::invalid_argument unless there is a follower and steps >= 1, for losses in bursts, and if a loop has no
/// equilibrium.
std::vector<SignalMoments> linked_moments(const PlatoonModel& model, const SignalLists& signals, std::int64_t steps,
                                          std::vector<double>* fourth_cumulants = nullptr);

/// Those of the tracking errors.
SignalMoments linked_error_moments(const PlatoonModel& model, std::size_t followers, std::int64_t steps,
                                   std::vector<double>* fourth_cumulants = nullptr);

}  // namespace platoon
