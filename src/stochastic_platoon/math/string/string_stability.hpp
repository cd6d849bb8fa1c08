#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/math/string/string_theory.hpp"

namespace platoon {

/// Stability of a platoon by Theorems 1 and 2.
struct StringStability {
  double spectral_radius = 0.0;                                 ///< rho(A)
  double peak_gain = std::numeric_limits<double>::quiet_NaN();  ///< ||T||_infinity; NaN if rho(A) >= 1
  double peak_frequency =
      std::numeric_limits<double>::quiet_NaN();  ///< its frequency [rad/sample], in [0, pi]; NaN if rho(A) >= 1
  bool mean_square_stable = false;               ///< rho(A) < 1, paper eq. (MSS_all)
  bool mean_bounded = false;   ///< and |T(e^{jw})| <= 1 for all w: the means stay bounded along the string
  bool string_stable = false;  ///< and the variances stay bounded along the string
  bool undecided = false;      ///< the digits of the model do not decide string stability
  std::optional<double> limit_variance = {};  ///< limit of the variances [m^2]; empty if there is none
  std::string reason = {};                    ///< one sentence that explains the verdict
  /// string_stable if decided.
  std::optional<bool> decision() const { return undecided ? std::nullopt : std::optional<bool>(string_stable); }
  std::optional<double> loss_gain = {};  ///< of links with a loss stage: see loss_gain()
};

/// Decides paper eq. (scalability_all),
/// \f[ |T(e^{jw})| < 1 \mbox{ for all } w > 0, \f]
/// without a grid: by the global minimum of -ln |T|^2 with its zero at w = 0 divided out (PatternGain). The verdict is
/// undecided if the digits of T's coefficients do not distinguish this minimum from zero.
///
/// In general the platoon is mean square stable exactly if every rho(A) < 1 and the second moments of no link's
/// predictions grow: p q ||L F||^2 < 1, for losses in bursts second_moment_radius() < 1. It is string stable exactly
/// if, in addition, |prod T^| < 1 over one pattern for all w > 0 and the loss gain is below 1.
///
/// The limit of corollary cor:stationary_all is, with < > the mean over the circle,
/// \f[ (\|S/M\|_2^2 - 1) P_d = P_d \langle |H T|^2 + |T|^2 |S|^2 / (1 - |T|^2) \rangle, \f]
/// computed by the right side; in a pattern `limit_variance` is the largest of its limits. It exists for every string
/// stable platoon. One exceptional kind satisfies |T| < 1 for all w > 0 but is not string stable: if 1 - |T|^2 is
/// flatter at w = 0 than |S|^2 (order w^6 over w^4), the variances grow without limit.
///
/// Where vehicles hear others than their predecessor, the gain is the spectral radius of the product over a pattern of
/// the companion matrices
///
///     [ T_i,i-1  T_i,i-2  ...  T_i,i-r ]
///     [ 1        0        ...  0       ]  ...
///
/// sought on a grid of frequencies and refined, for one vehicle ahead |T|. Inputs from the leader add noise alone. At
/// w = 0 one eigenvalue may be 1, in whose mode all vehicles move alike. With another of modulus 1 (as where all hear
/// the second vehicle ahead, and -1 is one) the variances of the distances grow without bound: not string stable.
/// `with_limit`: false leaves out the limit, and where others are heard the value of the loss gain, for which spectra
/// are narrow near the border of stability.
StringStability string_stability(const StringTheory& theory, bool with_limit = true);

/// The same by the theory that covers a model. Throws std::invalid_argument for a model without one: see no_theory().
inline StringStability string_stability(const PlatoonModel& model) {
  return string_stability(*StringTheory::of(model));
}

/// Positive exactly if string_stability() finds the platoon string stable, and continuous there: the smaller of the
/// least attenuation -ln |gain|^2 and 1 minus the loss gain. Where others are heard, the attenuation is that at low
/// frequencies, and the loss gain has an accuracy of a few hundredths of its distance from 1; -1 where no spectrum
/// resolves it.
double string_margin(const StringTheory& theory);
inline double string_margin(const PlatoonModel& model) {
  return string_margin(*StringTheory::of(model));
}

/// What verdicts call the gain that must be below 1: |T|, |T^| over links with losses, delay or other noise, |Gamma|
/// for a vehicle with radio, |T^| of one pattern for several vehicles, the spectral radius where others are heard.
std::string gain_name(const PlatoonModel& model);

}  // namespace platoon
