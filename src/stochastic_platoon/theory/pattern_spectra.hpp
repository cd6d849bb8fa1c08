#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "stochastic_platoon/theory/linked_vehicle.hpp"
#include "stochastic_platoon/theory/pattern_gain.hpp"

namespace platoon {

/// One pattern's vehicles at the nodes of a quadrature over the circle: what means of spectra are taken from.
class PatternSpectra {
public:
  /// `with_margin`: so fine that quotients by pattern_margin() are resolved, too. refinement >= 0 halves the
  /// panels that often.
  PatternSpectra(const std::vector<LinkedVehicle>& vehicles, const PatternGain& pattern_gain,
                 bool with_margin, int refinement);

  Eigen::ArrayXd weight;
  /// Of each vehicle the fields of LinkedVehicleValue, a row per node.
  std::vector<Eigen::ArrayXd> gain, margin, loss_gain, innovation, noise, complement, headway;

  /// Over the circle, of values at the nodes.
  double mean(const Eigen::ArrayXd& values) const { return (weight * values).sum(); }

  /// Takes the spectrum of y about its mean from in front of vehicle j to behind it, which adds `added` to it, and gives
  /// that of zeta: |1 - H T^|^2 Phi + |H|^2 added.
  Eigen::ArrayXd pass(std::size_t j, const Eigen::ArrayXd& added, Eigen::ArrayXd& spectrum) const;

  /// 1 - prod |T^|^2, as a sum without cancellation where no vehicle's gain is above 1.
  Eigen::ArrayXd pattern_margin() const;

  /// prod |T^|^2 over the vehicles behind `from` and before `to`, once around the pattern where these are equal.
  Eigen::ArrayXd between(std::size_t from, std::size_t to) const;

  /// The spectrum in front of vehicle j of an endless string, where vehicle l adds added[l] to its own.
  Eigen::ArrayXd before(std::size_t j, const std::vector<Eigen::ArrayXd>& added) const;
};

}  // namespace platoon
