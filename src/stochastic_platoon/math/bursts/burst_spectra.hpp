#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <memory>
#include <vector>

#include "stochastic_platoon/math/bursts/burst_scatter.hpp"
#include "stochastic_platoon/math/bursts/burst_vehicle.hpp"
#include "stochastic_platoon/math/links/pattern_factors.hpp"
#include "stochastic_platoon/math/numerics/quadrature.hpp"

namespace platoon {

/// The gains of a pattern whose links lose in bursts, to compute means of spectra, at nodes in (0, pi). The pattern
/// must be mean square stable and outlive the object.
class BurstSpectra : public PatternFactors {
public:
  /// Equally spaced frequencies w_j = 2 pi (j + 1/2) / n, which converge geometrically with n, a power of two, at least
  /// 8. O(n log n) for scattered().
  BurstSpectra(const BurstPattern& pattern, std::size_t nodes);

  /// The nodes of a half_circle_quadrature(), which resolves narrow features of slow vehicles and near the border of
  /// stability with few nodes, and need not resolve the memory of the chains (see MemoryWeights). O(nodes^2) for
  /// scattered().
  BurstSpectra(const BurstPattern& pattern, const Quadrature& rule);

  /// Further values of one vehicle type.
  struct Type {
    Eigen::ArrayXd own;                          ///< |T|^2 of the vehicle alone
    Eigen::ArrayXd passed;                       ///< |T_L|^2 of its link
    Eigen::ArrayXd complement;                   ///< |1 - H T^|^2
    Eigen::ArrayXd spacing_gain;                 ///< |H|^2
    Eigen::ArrayXd noise;                        ///< |W|^2 P_d + D^2 / 12
    std::shared_ptr<const BurstScatter> losses;  ///< none without losses; shared by all types with the same ones
  };
  const Type& of(std::size_t follower) const { return types_[type(follower)]; }
  const Eigen::ArrayXd& gain_of(std::size_t follower) const { return gain[type(follower)]; }

  /// The spectrum that the losses of `follower` scatter from its predecessor's: < g(w, nu) |u|^2 Phi >_nu. 0 without
  /// losses.
  Eigen::ArrayXd scattered(std::size_t follower, const Eigen::ArrayXd& spectrum) const;

  /// The spectrum that a follower adds to that of its position by the noise of its link, and by losses at this speed [m
  /// per step]; without the part scattered from its predecessor's spectrum.
  Eigen::ArrayXd added(std::size_t follower, double speed) const;

private:
  void evaluate(const BurstPattern& pattern, const Quadrature* rule);
  void add(const BurstVehicle& vehicle, std::shared_ptr<const BurstScatter> losses);

  Eigen::ArrayXd node_;
  std::vector<Type> types_;
};

}  // namespace platoon
