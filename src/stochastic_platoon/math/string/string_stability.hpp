#pragma once

#include <limits>
#include <optional>
#include <string>

#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/math/string/pattern_gain.hpp"

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
  std::optional<double> loss_gain = {};  ///< for links with losses: see linked_string_stability()
};

/// Judges |prod T| of a mean square stable string alone: sets the peak, mean_bounded and, for a negative verdict, the
/// reason. True if |prod T| < 1 for all w > 0.
bool judge_gain(const PatternGain& gain, const std::string& name, StringStability& verdict);

/// Judges the loss gain of a string that judge_gain() accepts: sets the reason of a negative verdict. `doubt`: the
/// accuracy of the loss gain. `losses`: their name in it. True if the loss gain is below 1.
bool judge_losses(double loss_gain, double doubt, const std::string& losses, StringStability& verdict);

/// Reason of a positive verdict; `loss_gain`: that of a string with losses.
std::string reason_of_stability(double spectral_radius, const std::string& name, std::optional<double> loss_gain = {});

/// Reason of a negative verdict where 1 - |prod T|^2 vanishes faster at w = 0 than the numerators it divides.
std::string reason_of_growth_at_zero(const std::string& name);

/// Decides paper eq. (scalability_all),
/// \f[ |T(e^{jw})| < 1 \mbox{ for all } w > 0, \f]
/// without a grid: by the global minimum of -ln |T|^2 with its zero at w = 0 divided out (PatternGain). The verdict is
/// undecided if the digits of T's coefficients do not distinguish this minimum from zero.
///
/// The limit of corollary cor:stationary_all is, with < > the mean over the circle,
/// \f[ (\|S/M\|_2^2 - 1) P_d = P_d \langle |H T|^2 + |T|^2 |S|^2 / (1 - |T|^2) \rangle, \f]
/// computed by the right side. It exists for every string stable platoon. One exceptional kind satisfies |T| < 1 for
/// all w > 0 but is not string stable: if 1 - |T|^2 is flatter at w = 0 than |S|^2 (order w^6 over w^4), the variances
/// grow without limit.
///
/// For a platoon other than the paper's this function returns linked_string_stability(), or burst_string_stability()
/// for losses in bursts.
///
/// Throws std::invalid_argument if S has fewer than two zeros at z = 1 or h is not positive.
StringStability string_stability(const PlatoonModel& model);

}  // namespace platoon
