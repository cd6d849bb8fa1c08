#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <vector>

#include "stochastic_platoon/math/links/linked_pattern.hpp"
#include "stochastic_platoon/math/links/loss_scatter.hpp"

namespace platoon {

/// The gains of one pattern's vehicles at the nodes of a mean over the circle. Spectra have one row per node. The
/// pattern must be mean square stable.
class StringSpectra {
public:
  StringSpectra(const LinkedPattern& pattern, SpectralNodes nodes);

  /// The fields of InputValue, and the losses: none if nothing is lost; shared by all links with the same ones.
  struct Input {
    Eigen::ArrayXd own, passed, noise;
    std::shared_ptr<const LossScatter> losses;
  };

  /// One vehicle type: the fields of LinkedVehicleValue. On panels with more than a period of a delay's z^m, the term
  /// in it of the complements, -2 Re H T^ and -2 Re T^, comes with weights that integrate the product of z^-m and a
  /// polynomial (Filon).
  struct Type {
    Eigen::ArrayXd gain, margin, complement, spacing_gain, of_gap, sent;
    std::vector<Input> inputs;  ///< the position and, with feed-forward, the predecessor's input
  };

  std::size_t size() const { return order_.size(); }  ///< number of vehicles in the pattern
  std::size_t type(std::size_t follower) const { return order_[follower % size()]; }
  const Type& operator[](std::size_t follower) const { return types_[type(follower)]; }
  Eigen::Index nodes() const { return nodes_.count(); }
  const Eigen::ArrayXd& from_one() const { return from_one_; }  ///< 1 - cos w

  /// Mean over the circle of values at the nodes.
  double mean(const Eigen::ArrayXd& values) const { return (nodes_.weight * values).sum(); }

  /// Spectrum sent over link `link` of a follower behind a position with this spectrum.
  Eigen::ArrayXd at_link(std::size_t follower, std::size_t link, const Eigen::ArrayXd& spectrum) const;

  /// 1 - prod |T^|^2 over the pattern, as accurate as each vehicle's own margin. Uses logarithms: at a resonance one
  /// vehicle's gain may be 1e9 and that of the product 1e-9.
  Eigen::ArrayXd pattern_margin() const;

  /// The spectrum in front of vehicle 0 of an endless string in which vehicle l adds added[l] to the spectrum. The
  /// spectrum in front of vehicle j + 1 is gain times the one in front of vehicle j, plus added[j]. `whole`: the
  /// pattern_margin().
  Eigen::ArrayXd in_front(const std::vector<Eigen::ArrayXd>& added, const Eigen::ArrayXd& whole) const;

  /// Mean of zeta's spectrum of a follower behind a predecessor with this spectrum that adds `added` to the spectrum:
  /// |1 - H T^|^2 Phi + |H|^2 added.
  double error_variance(std::size_t follower, const Eigen::ArrayXd& spectrum, const Eigen::ArrayXd& added) const;

private:
  void add(const LinkedVehicle& vehicle, std::vector<std::shared_ptr<const LossScatter>> losses);

  SpectralNodes nodes_;
  std::vector<std::size_t> order_;  ///< index of the type at each place of the pattern
  std::vector<Type> types_;
  Eigen::ArrayXd from_one_;
};

}  // namespace platoon
