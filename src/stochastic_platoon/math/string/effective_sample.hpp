#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/math/statistics/agreement.hpp"

namespace platoon {

/// The autocovariance of one follower's stationary error, and the effective sample size of averages over any number of
/// its steps.
///
/// For n successive values of a stationary normal error of mean 0 with covariance matrix S, S_tu = R(t - u), and 1 the
/// vector of n ones, exactly for every n:
///
///     n^2 E mean^2 = 1'S1 = sum (n - |t|) R(t),
///     (n - 1) E s^2 = n P - 1'S1 / n,
///     (n - 1)^2 var s^2 = 2 (tr S^2 - 2 1'S^2 1 / n + (1'S1 / n)^2),     tr S^2 = sum (n - |t|) R(t)^2,
///
/// sums over |t| < n. From twice the correlation length on, each sum is linear in n, and its coefficients are stored.
/// To leading order in 1 / n the effective numbers are n P / Phi(0) and n P^2 / < Phi^2 >, with the spectrum Phi (M. B.
/// Priestley, Spectral Analysis and Time Series, 1981, section 5.3); if Phi(0) is far below P, they are far too large.
class ErrorCorrelation {
public:
  /// Unknown correlation.
  ErrorCorrelation();

  /// R(0), R(1), ... up to the last nonzero value, and the sum of R(t) over all t of either sign, all divided by R(0).
  /// `keep` stores the values, which of() needs for few steps.
  ErrorCorrelation(std::vector<double> autocorrelation, double sum, bool keep);

  /// Number of steps after which errors count as uncorrelated; 0 if unknown.
  std::size_t length() const { return length_; }

  /// Share of independent values among `steps` steps in `stretches` independent stretches of successive steps. The
  /// stretches have equal lengths, or any lengths of at least 2 length(). NaN for fewer than two steps per stretch, for
  /// an unknown correlation, and for stretches of fewer than 2 length() steps if the autocorrelation was not kept.
  IndependentShare of(std::uint64_t steps, std::uint64_t stretches = 1) const;

private:
  std::size_t length_ = 0;
  double sum_, sum_of_lags_;         ///< sums of R(t) and |t| R(t)
  double squares_, square_of_lags_;  ///< sums of R(t)^2 and |t| R(t)^2
  double boundary_;                  ///< n (sum R)^2 - 1'S^2 1
  std::vector<double> kept_;
};

/// The correlation of each follower's tracking error, with Phi_zeta_i as in linked_string.hpp. Fast Fourier transforms
/// of a length that doubles until the autocorrelation ends within it; 1e-9 relative. Throws std::invalid_argument
/// unless followers >= 1.
///
/// The correlation is unknown
/// - from the first follower behind a lossy link on, as errors are not normal there;
/// - throughout if rho(A) >= 1;
/// - if the spectrum leaves the range of double;
/// - if errors are correlated over more than 2^18 steps, or fewer in strings of more than 500.
///
/// Dithered quantisation counts as normal: its fourth cumulant is negative, so a standard error is too large rather
/// than too small.
std::vector<ErrorCorrelation> error_correlations(const PlatoonModel& model, std::size_t followers);

}  // namespace platoon
