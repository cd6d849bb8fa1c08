#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/math/string/string_theory.hpp"

namespace platoon {

/// Stationary moments of one signal s of several vehicles.
struct StationaryMoments {
  std::vector<double> mean;      ///< at the leader's last speed
  std::vector<double> variance;  ///< infinity beyond the range of double
  std::vector<double> change;    ///< variance of s(k) - s(k-1), that is 2 (variance - covariance of both)
};

struct StationarySignal {
  StationaryMoments followers;             ///< of followers 1, ..., N; NaN if a loop is not stable
  std::optional<StationaryMoments> limit;  ///< at each place of the pattern in an endless string, if all are finite

  /// The largest variance of `limit`.
  std::optional<double> limit_variance() const;
};

/// Stationary moments of the signals of these names (see signal_kinds()), in the order of the names.
///
/// With < > the mean over the circle, Phi_i the spectrum of y_i about its mean, N_i the spectrum that noises and losses
/// of follower i add, and t = 1 - cos w,
/// \f[ \Phi_i = |\hat T|^2 \Phi_{i-1} + N_i, \qquad \Phi_0 = 0. \f]
/// The variances of the gap and of the n-th derivative are
/// \f[ \langle |1 - \hat T|^2 \Phi_{i-1} + N_i \rangle, \qquad \langle (2 t / T_s^2)^n \Phi_i \rangle, \f]
/// with the T^ of follower i, and `change` with a further factor 2 t. At v metres per step the gap has the mean
/// delta_i + h_i v + (mean of the tracking error) - (length of vehicle i-1).
/// In a string whose vehicles hear any vehicles ahead, and for the control input y_i / G, a signal is a filter on the
/// positions of two vehicles, whose spectra and cross spectrum are those of HearingSpectra; 1e-9 relative.
///
/// The limits exist if the string is string stable and if 1 - |prod T^|^2 over one pattern, divided by the spectra of
/// the noises, has at most as many zeros t as the numerator has: 1 for gap and speed, 2 for the acceleration, 3 for the
/// jerk. 1e-11 relative.
///
/// `string_stable`: the verdict of string_stability(). Throws std::invalid_argument unless followers >= 1, and for an
/// unknown name.
std::vector<StationarySignal> stationary_signals(const StringTheory& theory, const std::vector<std::string>& names,
                                                 std::size_t followers, bool string_stable);
inline std::vector<StationarySignal> stationary_signals(const PlatoonModel& model,
                                                        const std::vector<std::string>& names, std::size_t followers,
                                                        bool string_stable) {
  return stationary_signals(*StringTheory::of(model), names, followers, string_stable);
}

}  // namespace platoon
