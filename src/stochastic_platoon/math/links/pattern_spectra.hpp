#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "stochastic_platoon/math/links/linked_vehicle.hpp"
#include "stochastic_platoon/math/links/pattern_factors.hpp"
#include "stochastic_platoon/math/response/pattern_gain.hpp"

namespace platoon {

/// The gains of a pattern over links without losses or with independent ones, to compute means of spectra.
struct PatternSpectra : PatternFactors {
  /// `with_margin`: also resolve quotients by pattern_margin(). refinement >= 0: number of times the panels are halved.
  PatternSpectra(const LinkedPattern& pattern, const PatternGain& gain, bool with_margin, int refinement);

  /// Fields of InputValue, one row per node.
  struct Input {
    Eigen::ArrayXd loss_gain, passed, innovation, noise;
  };
  Eigen::ArrayXd from_one;  ///< 1 - cos w
  /// Per vehicle type, the fields of LinkedVehicleValue; `input` has one entry per link.
  std::vector<Eigen::ArrayXd> spacing_gain, sent;
  std::vector<std::vector<Input>> input;
  /// |1 - H T^|^2; on panels with more than a period of a delay's z^m, 1 + |H T^|^2, without the term -2 Re H T^.
  std::vector<Eigen::ArrayXd> complement;
  /// -2 Re H T^ on those panels, with weights that integrate the product of z^-m and a polynomial (Filon); 0 elsewhere.
  std::vector<Eigen::ArrayXd> delayed;
  /// |1 - T^|^2, with -2 Re T^ on those panels computed in the same way.
  std::vector<Eigen::ArrayXd> of_gap;

  /// Spectrum sent over link `link` of a vehicle behind a predecessor of type `before` whose position has this
  /// spectrum.
  Eigen::ArrayXd at_link(std::size_t link, std::size_t before, const Eigen::ArrayXd& spectrum) const {
    return link == 0 ? spectrum : Eigen::ArrayXd(sent[before] * spectrum);
  }

  /// The spectrum that the noises of its links add to the position of a vehicle of this type.
  Eigen::ArrayXd added_by_noise(std::size_t type) const;

  /// Mean of zeta's spectrum behind a predecessor with this spectrum, for a vehicle of this type that adds `added` to
  /// the spectrum: |1 - H T^|^2 Phi + |H|^2 added.
  double error_variance(std::size_t type, const Eigen::ArrayXd& spectrum, const Eigen::ArrayXd& added) const;
};

}  // namespace platoon
