#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <memory>
#include <vector>

#include "stochastic_platoon/math/numerics/quadrature.hpp"
#include "stochastic_platoon/math/string/burst_scatter.hpp"
#include "stochastic_platoon/math/string/burst_vehicle.hpp"

namespace platoon {

/// Gains of one pattern's vehicles at the nodes of a quadrature over the circle, to compute means of spectra. Spectra
/// have one row per node in (0, pi). The pattern must be mean square stable and outlive the object.
class BurstSpectra {
public:
  /// Equally spaced frequencies w_j = 2 pi (j + 1/2) / n, which converge geometrically with n, a power of two, at least
  /// 8. O(n log n) for scattered().
  BurstSpectra(const BurstPattern& pattern, std::size_t nodes);

  /// The nodes of a half_circle_quadrature(), which resolves narrow features of slow vehicles and near the border of
  /// stability with few nodes, and need not resolve the memory of the chains (see MemoryWeights). O(nodes^2) for
  /// scattered().
  BurstSpectra(const BurstPattern& pattern, const Quadrature& rule);

  const BurstPattern& pattern() const { return *pattern_; }
  Eigen::Index size() const { return weight_.size(); }

  /// Fields of one vehicle type.
  struct Type {
    Eigen::ArrayXd gain;                         ///< |T^|^2
    Eigen::ArrayXd margin;                       ///< 1 - |T^|^2
    Eigen::ArrayXd own;                          ///< |T|^2 of the vehicle alone
    Eigen::ArrayXd passed;                       ///< |T_L|^2 of its link
    Eigen::ArrayXd complement;                   ///< |1 - H T^|^2
    Eigen::ArrayXd headway;                      ///< |H|^2
    Eigen::ArrayXd noise;                        ///< |W|^2 P_d + D^2 / 12
    std::shared_ptr<const BurstScatter> losses;  ///< none without losses; shared by all types with the same ones
  };
  const Type& of(std::size_t follower) const { return types_[pattern_->type(follower)]; }

  /// Mean over the circle of values at the nodes.
  double mean(const Eigen::ArrayXd& values) const { return (weight_ * values).sum(); }

  /// The spectrum that the losses of `follower` scatter from its predecessor's: < g(w, nu) |u|^2 Phi >_nu. 0 without
  /// losses.
  Eigen::ArrayXd scattered(std::size_t follower, const Eigen::ArrayXd& spectrum) const;

  /// The spectrum that a follower adds to that of its position by the noise of its link, and by losses at this speed [m
  /// per step]; without the part scattered from its predecessor's spectrum.
  Eigen::ArrayXd added(std::size_t follower, double speed) const;

  /// 1 - prod |T^|^2 over the pattern, as accurate as each vehicle's own margin.
  Eigen::ArrayXd pattern_margin() const;

  /// The spectrum in front of vehicle 0 of an endless string in which vehicle l adds added[l].
  Eigen::ArrayXd in_front(const std::vector<Eigen::ArrayXd>& added, const Eigen::ArrayXd& margin) const;

private:
  void evaluate(const Quadrature* rule);
  Type values_of(const BurstVehicle& vehicle, std::shared_ptr<const BurstScatter> losses) const;

  const BurstPattern* pattern_;
  Eigen::ArrayXd node_, weight_;
  std::vector<Type> types_;
};

}  // namespace platoon
