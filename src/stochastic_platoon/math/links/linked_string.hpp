#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "stochastic_platoon/math/links/string_spectra.hpp"
#include "stochastic_platoon/math/model/signal.hpp"

namespace platoon {

/// Stationary theory of a platoon over links of any losses, homogeneous or patterned; `speed` v in metres per step.
/// With < > the mean over the circle, Phi_i the spectrum of y_i about its mean, Phi_0 = 0, sums over the links l of
/// follower i with N, T_L, m and the noise N_d of link l (see LinkedVehicleValue), Psi_l the spectrum of the values
/// sent over it, Phi_{i-1} for the position and Phi_{i-1} / |G_{i-1}|^2 for the predecessor's input, and u, g as in
/// LossKernel,
/// \f[ E_i = \sum_l |N|^2 (|T_L|^2 N_d + \langle g(w, \nu) |u|^2 (\Psi_l + N_d) \rangle
///         + v^2 (c_1 + 2 c_2 + \ldots)^2 g(w, 0)), \f]
/// \f[ \Phi_i = |\hat T|^2 \Phi_{i-1} + E_i, \qquad
///     P_i = \langle |1 - H \hat T|^2 \Phi_{i-1} + |H|^2 E_i \rangle. \f]
/// The last term of E_i is that of the position alone: inputs are 0 at constant speed. For independent losses
/// g |u|^2 = kappa |F(w)|^2 |(1 - L) F|^2(nu), and the last term is kappa |F|^2 (v (c_1 + 2 c_2 + ...) / p)^2.
///
/// The functions require a mean square stable pattern; those of an endless string, a positive gain_margin(), too.
/// 1e-12 relative; with bursts of mean length b 1e-14 b, and near the border of stability less in a limit.

/// A walk along the string, from the leader on (see StationaryTheory).
class LinkedWalk {
public:
  /// `spectra` must outlive the object.
  LinkedWalk(const StringSpectra& spectra, double speed);

  /// From the first place of a pattern on, behind a position with this spectrum.
  LinkedWalk(const StringSpectra& spectra, double speed, Eigen::ArrayXd ahead);

  /// From the first place of a pattern on in an endless string.
  static LinkedWalk behind_endless(const StringSpectra& spectra, double speed);

  /// What each input of the next follower adds to the spectrum of its position.
  std::vector<Eigen::ArrayXd> added();

  /// Passes the next follower, which adds this.
  void pass(Eigen::ArrayXd added);

  /// The variance of the tracking error of the follower that was passed last.
  double error_variance() const { return spectra_->error_variance(next_ - 1, before_, added_); }

  /// The variances of a signal of this follower, and of the change of the signal from step to step.
  std::array<double, 2> moments(const Signal& signal) const;

private:
  const StringSpectra* spectra_;
  double speed_;
  bool behind_leader_;  ///< whose position has no spectrum
  std::size_t next_ = 0;
  Eigen::ArrayXd spectrum_;                            ///< in front of the next follower
  Eigen::ArrayXd before_, added_;                      ///< in front of the last one, and what it added
  std::vector<std::vector<Eigen::ArrayXd>> constant_;  ///< per type: what its inputs add at the leader
};

/// The limit of the variance [m^2] at each place of the pattern of an endless string.
std::vector<double> limit_variances(const LinkedPattern& pattern, double speed);

/// The loss gain of an endless string: the spectral radius of the operator from the drives f_l = |u_l|^2 Psi_l of the
/// losses of every link l of the pattern to those that they cause at every link, over all repetitions; 0 without
/// losses. With S the factor from the position in front to what is sent over link j, 1 or 1 / G,
///
///     f_j' = |u_j S_j|^2 sum_l (product of |T^|^2 between l and j) |N_l|^2 < g_l(w, nu) f_l > / (1 - prod |T^|^2)
double loss_gain(const LinkedPattern& pattern);

/// 1 / loss gain - 1, with the exact sign at less cost; infinite without losses.
double loss_margin(const LinkedPattern& pattern);

}  // namespace platoon
