#pragma once

#include <cstddef>
#include <vector>

#include "stochastic_platoon/math/links/linked_pattern.hpp"
#include "stochastic_platoon/math/string/string_theory.hpp"

namespace platoon {

/// Stationary theory of a platoon over links of any losses, homogeneous or patterned; v is the speed in metres per
/// step. With < > the mean over the circle, Phi_i the spectrum of y_i about its mean, Phi_0 = 0, sums over the links l
/// of follower i with N, T_L, m and the noise N_d of link l (see LinkedVehicleValue), Psi_l the spectrum of the values
/// sent over it, Phi_{i-1} for the position and Phi_{i-1} / |G_{i-1}|^2 for the predecessor's input, and u, g as in
/// LossKernel,
/// \f[ E_i = \sum_l |N|^2 (|T_L|^2 N_d + \langle g(w, \nu) |u|^2 (\Psi_l + N_d) \rangle
///         + v^2 (c_1 + 2 c_2 + \ldots)^2 g(w, 0)), \f]
/// \f[ \Phi_i = |\hat T|^2 \Phi_{i-1} + E_i, \qquad
///     P_i = \langle |1 - H \hat T|^2 \Phi_{i-1} + |H|^2 E_i \rangle. \f]
/// The last term of E_i is that of the position alone: inputs are 0 at constant speed. For independent losses
/// g |u|^2 = kappa |F(w)|^2 |(1 - L) F|^2(nu), and the last term is kappa |F|^2 (v (c_1 + 2 c_2 + ...) / p)^2.
///
/// 1e-12 relative; with bursts of mean length b 1e-14 b, and near the border of stability less in a limit.
class LinkedTheory : public StringTheory {
public:
  /// `known`: see StringTheory::of(). Throws std::invalid_argument for a model without theory, or whose vehicles hear
  /// others than their predecessor.
  explicit LinkedTheory(const PlatoonModel& model, const LinkedTheory* known = nullptr)
      : StringTheory(model), pattern_(model, known != nullptr ? known->pattern_ : LinkedPattern()) {}

  double spectral_radius() const override { return pattern_.spectral_radius(); }
  double growth() const override { return pattern_.loss_feedback(); }
  std::vector<double> means(std::size_t followers) const override;
  std::vector<double> gains(const std::vector<double>& frequencies) const override;
  JudgedGain judged_gain() const override;
  bool has_cross_spectra() const override { return false; }
  int zeros_at_zero() const override { return pattern_.gain().zeros() - pattern_.zeros_at_zero().noise; }

  /// The loss gain of an endless string: the spectral radius of the operator from the drives f_l = |u_l|^2 Psi_l of the
  /// losses of every link l of the pattern to those that they cause at every link, over all repetitions; 0 without
  /// losses. With S the factor from the position in front to what is sent over link j, 1 or 1 / G,
  ///
  ///     f_j' = |u_j S_j|^2 sum_l (product of |T^|^2 between l and j) |N_l|^2 < g_l(w, nu) f_l > / (1 - prod |T^|^2)
  StringEnd end(bool with_variances) const override;

  double gain_margin() const override { return pattern_.gain_margin(); }
  double loss_gain_beside_one() const override;
  double loss_margin() const override { return 1.0 / loss_gain_beside_one() - 1.0; }
  double border_accuracy() const override { return 1e-12; }
  std::vector<double> settled(std::size_t followers, const Values& values) const override;
  std::vector<double> settled_behind_endless(const Values& values) const override;

private:
  LinkedPattern pattern_;
};

}  // namespace platoon
