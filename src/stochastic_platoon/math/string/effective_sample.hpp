#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "stochastic_platoon/math/model/platoon_model.hpp"

namespace platoon {

/// What one step of an average over time is worth, in independent errors, as successive ones are correlated: n steps
/// have a mean of variance P / (n mean), and an unbiased variance s^2 of variance 2 P^2 / ((n - 1) variance) and of
/// mean P expected.
struct EffectiveSample {
  double mean = 1.0;
  double variance = 1.0;
  double expected = 1.0;
};

/// The autocovariance of one follower's stationary error, and what averages over any number of its steps are worth.
///
/// For n successive values of a stationary normal error of mean 0, whose covariance matrix is S, S_tu = R(t - u), and
/// with 1 the vector of n ones, exactly for every n:
///     n^2 E mean^2 = 1'S1 = sum (n - |t|) R(t),
///     (n - 1) E s^2 = n P - 1'S1 / n,
///     (n - 1)^2 var s^2 = 2 (tr S^2 - 2 1'S^2 1 / n + (1'S1 / n)^2),     tr S^2 = sum (n - |t|) R(t)^2,
/// sums over |t| < n. From twice the correlation length on each is linear in n, and its coefficients are kept. To
/// leading order in 1 / n it is n P / Phi(0) and n P^2 / < Phi^2 >, with the spectrum Phi (M. B. Priestley, Spectral
/// Analysis and Time Series, 1981, section 5.3); where Phi(0) is far below P, that is much too much.
class ErrorCorrelation {
public:
  /// Of which nothing is known.
  ErrorCorrelation();

  /// R(0), R(1), ... over R(0), up to where they are 0 for good, and sum R(t) over all t of either sign; `keep` them
  /// for few steps, too.
  ErrorCorrelation(std::vector<double> autocorrelation, double sum, bool keep);

  /// Steps from which on errors count as uncorrelated; 0 where nothing is known.
  std::size_t length() const { return length_; }

  /// What a step of so many is worth, which are successive but for having come in some stretches, independent of each
  /// other: as long as each other, or of any length from twice length() on. NaN for fewer than two steps, where nothing
  /// is known, and for stretches of fewer than 2 length() steps where the autocorrelation was not kept.
  EffectiveSample of(std::uint64_t steps, std::uint64_t stretches = 1) const;

private:
  std::size_t length_ = 0;
  double sum_, sum_of_lags_;         ///< of R(t) and |t| R(t)
  double squares_, square_of_lags_;  ///< of R(t)^2 and |t| R(t)^2
  double boundary_;                  ///< n (sum R)^2 - 1'S^2 1
  std::vector<double> kept_;
};

/// That of each follower's tracking error, with Phi_zeta_i as in linked_string.hpp, by fast Fourier transforms of a
/// length that doubles until the autocorrelation ends within it. Nothing is known from the first follower on behind
/// whose link errors are not normal, as it loses packets, throughout when rho(A) >= 1, where the spectrum leaves the
/// range of double, and where errors are correlated over more than 2^18 steps, or fewer in strings of more than 500.
/// Dithered quantisation, which is not normal either, counts as normal: its own fourth cumulant is negative, so that a
/// standard error is too large rather than too small. 1e-9 relative. Throws std::invalid_argument unless followers
/// >= 1.
std::vector<ErrorCorrelation> error_correlations(const PlatoonModel& model, std::size_t followers);

}  // namespace platoon
