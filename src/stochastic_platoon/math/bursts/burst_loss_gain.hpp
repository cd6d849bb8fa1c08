#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "stochastic_platoon/math/bursts/burst_spectra.hpp"

namespace platoon {

/// The operator of loss gains (see loss_gain()) on the drives of all lossy places. Drives of places with
/// the same losses are adjacent.
class LossOperator {
public:
  explicit LossOperator(const BurstSpectra& spectra);

  Eigen::Index dimensions() const { return static_cast<Eigen::Index>(lossy_.size()) * spectra_.nodes(); }
  const Eigen::ArrayXd& margin() const { return margin_; }

  /// Adds to each vehicle's spectrum the part of these drives that its losses scatter.
  void add(const Eigen::VectorXd& drives, std::vector<Eigen::ArrayXd>& added) const;

  /// The drives in an endless string in which vehicle l adds added[l] to the spectrum.
  Eigen::VectorXd drives(const std::vector<Eigen::ArrayXd>& added) const;

  Eigen::VectorXd operator()(const Eigen::VectorXd& given) const;

private:
  const BurstSpectra& spectra_;
  Eigen::ArrayXd margin_;
  std::vector<std::size_t> lossy_;   ///< places in the pattern, in the order of their drives
  std::vector<Eigen::Index> drive_;  ///< of each place in the pattern, -1 without losses
};

/// values(spectra) of this number of followers, or of an endless string if there is none, with the number of nodes
/// increased until they settle: equally spaced nodes, or the few of a quadrature where slow vehicles, long bursts or
/// the border of stability would take thousands.
std::vector<double> settled_values(const BurstPattern& pattern, std::optional<std::size_t> followers,
                                   const std::function<std::vector<double>(const BurstSpectra&)>& values);

/// The loss gain of an endless string: the spectral radius of the operator from the drives f_l = |u_l|^2 Phi of the
/// losses at every place l of the pattern to those that they cause at every place, over all repetitions; 0 without
/// losses, and that of linked_string.hpp for independent ones. 1e-12 relative.
///
///     f_j' = |u_j|^2 sum_l (product of |T^|^2 between l and j) |T_l|^2 < g_l(w, nu) f_l > / (1 - prod |T^|^2)
double loss_gain(const BurstPattern& pattern);

/// 1 / loss gain - 1, with the exact sign at less cost; infinite without losses.
double loss_margin(const BurstPattern& pattern);

}  // namespace platoon
