#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "stochastic_platoon/math/string/linked_vehicle.hpp"
#include "stochastic_platoon/math/string/pattern_gain.hpp"

namespace platoon {

/// One pattern's vehicles at the nodes of a quadrature over the circle: what means of spectra are taken from.
class PatternSpectra {
public:
  /// `with_margin`: so fine that quotients by pattern_margin() are resolved, too. refinement >= 0 halves the
  /// panels that often.
  PatternSpectra(const LinkedPattern& pattern, const PatternGain& gain, bool with_margin, int refinement);

  Eigen::ArrayXd weight;
  /// Of each type of vehicle the fields of LinkedVehicleValue, a row per node.
  std::vector<Eigen::ArrayXd> gain, margin, loss_gain, innovation, noise, headway;
  /// |1 - H T^|^2 or, on panels with more than a period of a delay's z^m, 1 + |H T^|^2, without its 2 Re H T^.
  std::vector<Eigen::ArrayXd> complement;
  /// -2 Re H T^ there, by weights that integrate the product of z^-m and a polynomial (Filon); 0 elsewhere.
  std::vector<Eigen::ArrayXd> delayed;

  std::size_t size() const { return order_.size(); }                           ///< of the pattern
  std::size_t type(std::size_t j) const { return order_[j % order_.size()]; }  ///< of vehicle j

  /// Over the circle, of values at the nodes.
  double mean(const Eigen::ArrayXd& values) const { return (weight * values).sum(); }

  /// Mean of zeta's spectrum behind a predecessor of this spectrum, where the vehicle, of this type, adds `added` to
  /// it: |1 - H T^|^2 Phi + |H|^2 added.
  double error_variance(std::size_t type, const Eigen::ArrayXd& spectrum, const Eigen::ArrayXd& added) const;

  /// 1 - prod |T^|^2, to the digits of each vehicle's own 1 - |T^|^2.
  Eigen::ArrayXd pattern_margin() const;

  /// The spectrum in front of vehicle 0 of an endless string, where vehicle l adds added[l] to its own. That in front
  /// of vehicle j + 1 is gain times that in front of vehicle j, and added[j]. `margin`: the pattern_margin().
  Eigen::ArrayXd in_front(const std::vector<Eigen::ArrayXd>& added, const Eigen::ArrayXd& margin) const;

private:
  std::vector<std::size_t> order_;
};

}  // namespace platoon
