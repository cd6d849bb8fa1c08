#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/math/bursts/burst_link.hpp"
#include "stochastic_platoon/math/links/linked_vehicle.hpp"

namespace platoon {

/// One follower behind a link that may lose positions in bursts.
class BurstVehicle {
public:
  /// `known`: the same vehicle with another headway or other losses; it saves the search for zeros that do not depend
  /// on the headway. `before`: as of LinkedVehicle. Throws std::invalid_argument for a vehicle with feed-forward, and
  /// as BurstLink does unless `loss_feedback()` is 1 or more.
  explicit BurstVehicle(const VehicleModel& vehicle, const BurstVehicle* known = nullptr,
                        const VehicleModel* before = nullptr);

  /// The vehicle behind its link without losses.
  const LinkedVehicle& plain() const { return plain_; }

  /// The losses; null if no position is lost, or if the variance of the predictions does not settle.
  const BurstLink* losses() const { return losses_.get(); }

  const VehicleModel& vehicle() const { return vehicle_; }
  bool has_losses() const { return losses_ != nullptr; }
  double spectral_radius() const { return plain_.spectral_radius(); }  ///< rho(A)
  double loss_feedback() const { return loss_feedback_; }              ///< second_moment_radius() of the link

  /// Mean lag of the received position at constant speed [steps].
  double lag() const;

  /// |T^|^2 as a factor of the pattern's.
  RatedFactor factor() const;

  /// As LinkedVehicle::zeros_at_zero().
  ZerosAtZero zeros_at_zero() const;

  /// Whether this object describes `vehicle`, which differs at most in headway and losses.
  bool is_of(const VehicleModel& vehicle) const;

private:
  VehicleModel vehicle_;
  LinkedVehicle plain_;
  double loss_feedback_;
  std::shared_ptr<const BurstLink> losses_;
};

using BurstPattern = VehiclePattern<BurstVehicle>;

/// Whether a link of the string loses in bursts.
bool has_bursts(const PlatoonModel& model);

/// The reason why a platoon with losses in bursts has no theory: recorded losses, a radio, or losses that strictly
/// alternate with arrivals (q = 1/2 and mean burst 1). None if it has one.
std::optional<std::string> no_burst_theory(const PlatoonModel& model);

}  // namespace platoon
