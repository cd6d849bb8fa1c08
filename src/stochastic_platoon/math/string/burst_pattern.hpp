#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/math/string/burst_link.hpp"
#include "stochastic_platoon/math/string/linked_vehicle.hpp"

namespace platoon {

/// One follower behind a link that may lose positions in bursts.
class BurstVehicle {
public:
  /// `known`: the same vehicle with another headway or other losses; it saves the search for zeros that do not depend
  /// on the headway. Throws std::invalid_argument for a vehicle with feed-forward, and as BurstLink does unless
  /// `mean_square_stable()` is false.
  explicit BurstVehicle(const VehicleModel& vehicle, const BurstVehicle* known = nullptr);

  /// The vehicle behind its link without losses.
  const LinkedVehicle& plain() const { return plain_; }

  /// The losses; null if no position is lost, or if the variance of the predictions does not settle.
  const BurstLink* losses() const { return losses_.get(); }

  const VehicleModel& vehicle() const { return vehicle_; }
  double second_moment_radius() const { return second_moment_radius_; }  ///< of the link
  bool mean_square_stable() const { return plain_.spectral_radius() < 1.0 && second_moment_radius_ < 1.0; }

  /// Mean lag of the received position at constant speed [steps].
  double lag() const;

  /// |T^|^2 as a factor of the pattern's.
  RatedFactor factor() const;

  /// As LinkedVehicle::zeros_at_zero().
  ZerosAtZero zeros_at_zero() const;

private:
  VehicleModel vehicle_;
  LinkedVehicle plain_;
  double second_moment_radius_;
  std::shared_ptr<const BurstLink> losses_;
};

/// One pattern of the string: its vehicle types, each once, and their order.
struct BurstPattern {
  std::vector<BurstVehicle> types;
  std::vector<std::size_t> order;  ///< index of the type at each place of the pattern

  std::size_t size() const { return order.size(); }
  std::size_t type(std::size_t follower) const { return order[follower % order.size()]; }
  const BurstVehicle& operator[](std::size_t follower) const { return types[type(follower)]; }
  PatternGain gain() const;
  bool mean_square_stable() const;
  bool has_losses() const;
};

/// The pattern of a platoon. `known`: pattern of the same platoon with other headways or losses.
BurstPattern burst_pattern(const PlatoonModel& model, const BurstPattern& known = {});

/// Whether a link of the string loses in bursts.
bool has_bursts(const PlatoonModel& model);

/// The reason why a platoon with losses in bursts has no theory: recorded losses, a radio, or losses that strictly
/// alternate with arrivals (q = 1/2 and mean burst 1). None if it has one.
std::optional<std::string> no_burst_theory(const PlatoonModel& model);

}  // namespace platoon
