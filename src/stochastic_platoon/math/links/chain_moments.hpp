#pragma once

#include "stochastic_platoon/math/links/linked_moments.hpp"

namespace platoon {

/// Exact mean and variance of signals at every step of a platoon, homogeneous or patterned, whose vehicles hear any
/// vehicles ahead over links with any losses. The tables are in the order of the lists.
///
/// The covariance of the positions and, where a vehicle hears them, of the control inputs of the vehicles that others
/// behind still hear passes from vehicle to vehicle. With s = m + s~ the values that arrive on a link, S their
/// covariance including the noise of the link, x the registers relative to m (see LossKernel), u(k) = m(k) - c_1 m(k-1)
/// - ..., e = (1, 0, ..., 0)' and r~ = e' x,
///
///     mu_c(k) = A_c sum_a Pi_ac mu_a(k-1) - (0 or pi_c u(k)) e,
///     X_c(k, l) = A_c sum_a Pi_ac X_a(k-1, l) + (pi_c S(k, l) or 0) e  for all l,
///     Q_c(k) = A_c sum_a Pi_ac Q_a(k-1) A_c' + sym(b_c e') + e e' pi_c (S(k, k) or u(k)^2),
///     mu_c = E[x 1{theta = c}],   X_c = E[x(k) 1{theta(k) = c} s~(l)],   sym(M) = M + M',
///     b_c = A_c sum_a Pi_ac (X_a(k-1, k) or -u(k) mu_a(k-1)),
///
/// with the first of two values for an arrived mode c and the second for a lost one, and Y_c(l) = E[x(l) 1{theta(l) =
/// c} r~(k)], l > k, from Q_c(k) e on by
///
///     Y_c(l) = A_c sum_a Pi_ac Y_a(l-1) + e (E[s~(l) 1{theta(l) = c} r~(k)] or -u(l) E[1{theta(l) = c} r~(k)]),
///
/// both expectations by the powers of Pi. Their sum over c gives the covariance of the values that the vehicle uses; of
/// two values that are lost together, S, Q and Y are those of one with the other. As the losses of a link depend on
/// nothing else, the covariance of these with any other value is that of the sent ones, passed by the link on average.
/// The closed loop filters them all, and the initial position adds its own.
///
/// A signal is a weighted sum of the latest positions of two vehicles, its variance a quadratic form of their
/// covariance. Where the sum of its terms exceeds it so far that fewer than six digits are left, the variance is NaN;
/// those of tracking errors always have theirs.
///
/// O(followers (inputs steps)^2) time and O((inputs steps)^2) memory. 1e-11 relative; for a mean relative to the
/// positions, for a variance of differences to the variance of positions. Throws std::invalid_argument unless there is
/// a follower and steps >= 1, for the control input of vehicles that do not send it, and if a loop has no equilibrium.
std::vector<SignalMoments> chain_moments(const PlatoonModel& model, const SignalLists& signals, std::int64_t steps);

/// Those of the tracking errors.
SignalMoments chain_error_moments(const PlatoonModel& model, std::size_t followers, std::int64_t steps);

/// Whether the moments of every step take chain_moments(): losses with memory, any losses in a string that hears
/// more than predecessors, or of positions in a platoon that starts in steady motion.
bool needs_chain_moments(const PlatoonModel& model);

/// Most steps of chain_moments() for this number of followers: half a minute or this share of it, and some
/// matrices of 2000 x 2000 numbers; the more a vehicle hears, the fewer.
std::int64_t most_chain_steps(const PlatoonModel& model, std::size_t followers, double share_of_time = 1.0);

}  // namespace platoon
