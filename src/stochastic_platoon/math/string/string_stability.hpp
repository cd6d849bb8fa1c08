#pragma once

#include <limits>
#include <optional>
#include <string>

#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/math/string/pattern_gain.hpp"

namespace platoon {

/// What Theorems 1 and 2 say about a platoon.
struct StringStability {
  double spectral_radius = 0.0;                                 ///< rho(A)
  double peak_gain = std::numeric_limits<double>::quiet_NaN();  ///< norm of T at infinity; NaN when rho(A) >= 1
  double peak_frequency =
      std::numeric_limits<double>::quiet_NaN();  ///< where it is reached [rad/sample], in [0, pi]; NaN when rho(A) >= 1
  bool mean_square_stable = false;               ///< rho(A) < 1, paper eq. (MSS_all)
  bool mean_bounded = false;   ///< and |T(e^{jw})| <= 1 for all w: the means stay bounded along the string
  bool string_stable = false;  ///< and the variances stay bounded along the string
  bool undecided = false;      ///< the digits of the model do not tell whether the string is stable
  std::optional<double> limit_variance = {};  ///< their limit [m^2]; empty when they have none
  std::string reason = {};                    ///< one sentence: why, or why not
  /// string_stable where it is decided.
  std::optional<bool> decision() const { return undecided ? std::nullopt : std::optional<bool>(string_stable); }
  std::optional<double> loss_gain = {};  ///< of links that lose positions: see linked_string_stability()
};

/// Judges |prod T| of a mean square stable string alone: sets the peak, mean_bounded and, against, the reason. True
/// where |prod T| < 1 for all w > 0.
bool judge_gain(const PatternGain& gain, const std::string& name, StringStability& verdict);

/// Decides paper eq. (scalability_all), |T(e^{jw})| < 1 for all w > 0, without a grid: by the global minimum of
/// -ln |T|^2, its zero at w = 0 divided out (PatternGain). Where the digits of T's coefficients cannot tell this
/// minimum from zero, the verdict is undecided.
///
/// The limit is (||S/M||_2^2 - 1) P_d of corollary cor:stationary_all, computed as P_d times the mean over
/// the circle of |HT|^2 + |T|^2 |S|^2 / (1 - |T|^2). It exists for every string stable platoon but one kind:
/// where 1 - |T|^2 is flatter at w = 0 than |S|^2 (order w^6 over w^4), |T| < 1 for all w > 0 holds and the
/// variances grow all the same; such a platoon is not string stable.
///
/// Of any other platoon than the paper's it is linked_string_stability().
///
/// Throws std::invalid_argument when S has fewer than two zeros at z = 1 or h is not positive.
StringStability string_stability(const PlatoonModel& model);

}  // namespace platoon
