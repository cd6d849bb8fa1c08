#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "stochastic_platoon/math/model/platoon_model.hpp"

namespace platoon {

/// The bounds of Theorem 2 (teo:Lpmean_Lqvariance_all), evaluated for the inputs of this platoon. They hold for every
/// follower of a string of this length, or of any length if stated:
/// \f[ \|\mu_{\zeta_i}\|_{L_2} \le \alpha_1 + \beta_1, \qquad \|P_{\zeta_i}\|_{L_\infty} \le \alpha_2 + \beta_2. \f]
struct TheoremTwoBounds {
  double leader_norm;         ///< ||zeta_0||_{L_2} [m], over the given steps
  double initial_mean;        ///< ||mu_xi(0)||_2
  double initial_covariance;  ///< sigma_max(P_xi(0)), its supremum over all lengths

  std::optional<double> alpha_1;         ///< ||T||_infinity ||zeta_0||_{L_2}; any length; empty unless ||T|| <= 1
  std::optional<double> beta_1;          ///< ||mu_xi(0)||_2 times initial_mean_gain; empty if alpha_1 is
  std::optional<double> alpha_2;         ///< the limit variance; any length; empty unless string stable
  std::optional<double> beta_2;          ///< sigma_max(P_xi(0)) times initial_covariance_gain; empty if alpha_2 is
  std::optional<double> stated_beta_2;   ///< sigma_max(P_xi(0)) ||C||_2^2, as in the paper: not a bound in general
  std::optional<double> mean_bound;      ///< alpha_1 + beta_1 [m]
  std::optional<double> variance_bound;  ///< alpha_2 + beta_2 [m^2]
};

/// For long strings and slow loops beta_1 and beta_2 are looser but still bounds. With more than 240 states in all, or
/// if the dense sum does not converge in double, beta_1 uses initial_mean_gain_of_any_length. beta_2 uses the upper end
/// of initial_covariance_gain_within, computed within some milliseconds, or the square of
/// initial_mean_gain_of_any_length, whichever is smaller.
///
/// Throws as error_moments does. In the last lines of the paper's proof the names alpha_2 and beta_2 are exchanged, and
/// ||C||_2 lacks the square that its property (a) gives.
TheoremTwoBounds theorem_two_bounds(const PlatoonModel& model, std::size_t followers, std::int64_t steps);

/// The largest ratio of the L_2 norm of a mean to ||mu_xi(0)||_2, paper eq. (beta1_leader), over the string's A and C:
/// \f[ \max_i \rho(\sum_k A'^k C' \eta_i' \eta_i C A^k)^{1/2}. \f]
/// It grows with i, so i = N is decisive. Dense, O((nN)^3).
///
/// Throws std::invalid_argument if rho(A) >= 1 or followers < 1.
double initial_mean_gain(const StateSpace& vehicle, double headway, std::size_t followers);

/// A bound of initial_mean_gain for every length if ||T||_infinity <= 1: sup_w ||C (e^{jw} I - A)^{-1}||_2, which is
/// resolvent_peak. The mean is f(T(z)) applied to C (zI - A)^-1 with f(s) = sum_m mu_{N-m} s^m, and ||f(T)||_2 <=
/// ||f||_2 since T maps the outside of the unit disk into the disk and infinity to 0 (J. E. Littlewood, On inequalities
/// in the theory of functions, 1925).
double initial_mean_gain_of_any_length(const StateSpace& vehicle);

/// Interval that contains a supremum that was not computed to full accuracy.
struct GainEnclosure {
  double from;
  double to;
};

/// Enclosure of initial_covariance_gain from as many steps as `operations` additions and multiplications allow: a
/// single value if they suffice, otherwise from the largest value found to the bound by the remaining energy. Throws as
/// initial_covariance_gain does.
GainEnclosure initial_covariance_gain_within(const StateSpace& vehicle, std::size_t followers, double operations);

/// The largest ratio of a variance due to P_xi(0) to sigma_max(P_xi(0)), over the string's A and C,
/// \f[ \sup_{k, i \le N} \|\eta_i C A^k\|_2^2. \f]
/// The paper takes k = 0, ||C||_2^2, arguing that rho(A^k P A'^k) is largest there, which is not true in general.
/// Computed from the responses T^m C (zI - A)^-1 in O(followers steps), with enough steps for the remaining energy to
/// be below the largest value found.
///
/// Throws std::invalid_argument if rho(A) >= 1 or followers < 1.
double initial_covariance_gain(const StateSpace& vehicle, std::size_t followers);

}  // namespace platoon
