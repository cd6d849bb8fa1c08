#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/math/links/linked_vehicle.hpp"
#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/math/response/pattern_gain.hpp"

namespace platoon {

/// Whether a link of the string loses other than independently: in bursts, by a chain, by a trace, by the distance.
bool has_bursts(const PlatoonModel& model);

/// The reason why a platoon has no theory: limits of its vehicles, or a link without one. None if it has one.
std::optional<std::string> no_theory(const PlatoonModel& model);

/// One pattern of the string: its vehicle types, each once, and their order. In a string with radios, a type behind
/// unlike plants counts once for each of them.
struct LinkedPattern {
  std::vector<LinkedVehicle> types;
  std::vector<std::size_t> order;  ///< index of the type at each place of the pattern

  LinkedPattern() = default;

  /// The pattern of a platoon. `known`: pattern of the same platoon with other headways and links; its unchanged
  /// vehicles are reused. Throws std::invalid_argument for a model without theory.
  explicit LinkedPattern(const PlatoonModel& model, const LinkedPattern& known = {});

  std::size_t size() const { return order.size(); }
  std::size_t type(std::size_t follower) const { return order[follower % order.size()]; }
  const LinkedVehicle& operator[](std::size_t follower) const { return types[type(follower)]; }

  /// |prod T^|^2 over the pattern.
  PatternGain gain() const;

  /// The largest rho(A), and the largest growth of the second moments of predictions per step.
  double spectral_radius() const { return largest(&LinkedVehicle::spectral_radius); }
  double loss_feedback() const { return largest(&LinkedVehicle::loss_feedback); }
  bool mean_square_stable() const { return spectral_radius() < 1.0 && loss_feedback() < 1.0; }

  bool has_losses() const { return any(&LinkedVehicle::has_losses); }
  bool has_memory() const { return any(&LinkedVehicle::has_memory); }  ///< of losses

  /// The smallest multiplicities of all vehicles; those of the noise include the losses.
  ZerosAtZero zeros_at_zero() const;

  /// Whether 1 - |prod T^|^2 vanishes faster at w = 0 than the numerators it divides in a variance: the noises, times
  /// |1 - H T^|^2 for the errors and |1 - L|^2 for the losses.
  bool grows_at_zero(const PatternGain& pattern_gain) const;

  /// Positive exactly if string_stability() finds the platoon string stable, apart from the condition on the loss gain;
  /// needs no spectra. The smaller of 1 - rho(A), 1 - loss_feedback() and the least attenuation of |prod T^|^2; a
  /// positive margin is the least attenuation alone, which is smooth in the headway and in the losses.
  double gain_margin() const;

private:
  double largest(double (LinkedVehicle::*figure)() const) const;
  bool any(bool (LinkedVehicle::*condition)() const) const;
};

}  // namespace platoon
