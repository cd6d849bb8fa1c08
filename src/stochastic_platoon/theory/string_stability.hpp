#pragma once

#include <optional>
#include <string>

#include "stochastic_platoon/model/platoon_model.hpp"

namespace platoon {

/// What Theorems 1 and 2 say about a platoon.
struct StringStability {
  double spectral_radius;   ///< rho(A)
  double peak_gain;         ///< norm of T at infinity; NaN when rho(A) >= 1
  double peak_frequency;    ///< where it is reached [rad/sample], in [0, pi]; NaN when rho(A) >= 1
  bool mean_square_stable;  ///< rho(A) < 1, paper eq. (MSS_all)
  bool mean_bounded;        ///< and |T(e^{jw})| <= 1 for all w: the means stay bounded along the string
  bool string_stable;       ///< and the variances stay bounded along the string
  std::optional<double> limit_variance;  ///< their limit [m^2]; empty when they have none
  std::string reason;                    ///< one sentence: why, or why not
  std::optional<double> loss_gain = {};  ///< of links that lose positions: see linked_string_stability()
};

/// Decides paper eq. (scalability_all), |T(e^{jw})| < 1 for all w > 0, without a grid: |D|^2 - |N|^2 as a
/// polynomial in cos w, its zero at cos w = 1 divided out, is positive just when its minima are, and those
/// lie at sign changes of its derivative or at the ends of [-1, 1]. What cannot be told from zero by the
/// digits of T's coefficients counts as |T| = 1: bounded for the mean, not for the variance (Theorem 1).
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
