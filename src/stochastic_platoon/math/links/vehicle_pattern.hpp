#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include "stochastic_platoon/math/links/link_filter.hpp"
#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/math/response/pattern_gain.hpp"

namespace platoon {

/// One pattern of the string: its vehicle types, each once, and their order. In a string with radios, a type behind
/// unlike plants counts once for each of them. Vehicle is LinkedVehicle, for links with independent losses or none, or
/// BurstVehicle, for losses in bursts.
template <class Vehicle>
struct VehiclePattern {
  std::vector<Vehicle> types;
  std::vector<std::size_t> order;  ///< index of the type at each place of the pattern

  VehiclePattern() = default;

  /// The pattern of a platoon. `known`: pattern of the same platoon with other headways and links; its unchanged
  /// vehicles are reused. Throws as Vehicle does.
  explicit VehiclePattern(const PlatoonModel& model, const VehiclePattern& known = {}) {
    std::map<std::pair<std::size_t, std::size_t>, std::size_t> place;  // (model type, that of the predecessor)
    const std::vector<std::size_t> model_types = type_order(model);
    const bool sends = has_feed_forward(model);
    for (std::size_t j = 0, before = model_types.back(); j < model_types.size(); before = model_types[j++]) {
      const VehicleModel &vehicle = model.types[model_types[j]].vehicle, &predecessor = model.types[before].vehicle;
      const bool unlike = sends && !(predecessor.design->plant == vehicle.design->plant);
      const auto inserted =
          place.emplace(std::make_pair(model_types[j], unlike ? before : model_types[j]), types.size());
      if (inserted.second) {
        const Vehicle* const same = types.size() < known.types.size() ? &known.types[types.size()] : nullptr;
        types.push_back(
            same != nullptr && same->is_of(vehicle) ? *same : Vehicle(vehicle, same, unlike ? &predecessor : nullptr));
      }
      order.push_back(inserted.first->second);
    }
  }

  std::size_t size() const { return order.size(); }
  std::size_t type(std::size_t follower) const { return order[follower % order.size()]; }
  const Vehicle& operator[](std::size_t follower) const { return types[type(follower)]; }

  /// |prod T^|^2 over the pattern.
  PatternGain gain() const {
    std::vector<RatedFactor> factors;
    for (std::size_t type = 0; type < types.size(); ++type) {
      factors.push_back(types[type].factor());
      factors.back().factor.count = static_cast<long double>(std::count(order.begin(), order.end(), type));
    }
    return PatternGain(std::move(factors));
  }

  /// The largest rho(A), and the largest growth of the second moments of predictions per step.
  double spectral_radius() const { return largest(&Vehicle::spectral_radius); }
  double loss_feedback() const { return largest(&Vehicle::loss_feedback); }
  bool mean_square_stable() const { return spectral_radius() < 1.0 && loss_feedback() < 1.0; }

  bool has_losses() const {
    return std::any_of(types.begin(), types.end(), [](const Vehicle& vehicle) { return vehicle.has_losses(); });
  }

  /// The smallest multiplicities of all vehicles; those of the noise include the losses.
  ZerosAtZero zeros_at_zero() const {
    ZerosAtZero least{ZerosAtZero::kNone, ZerosAtZero::kNone, has_losses() ? 0 : ZerosAtZero::kNone};
    for (const Vehicle& vehicle : types) {
      const ZerosAtZero zeros = vehicle.zeros_at_zero();
      least.complement = std::min(least.complement, zeros.complement);
      least.innovation = std::min(least.innovation, zeros.innovation);
      least.noise = std::min(least.noise, zeros.noise);
    }
    if (least.noise == ZerosAtZero::kNone) least.noise = 0;  // as for any noise, however small
    return least;
  }

  /// Whether 1 - |prod T^|^2 vanishes faster at w = 0 than the numerators it divides in a variance: the noises, times
  /// |1 - H T^|^2 for the errors and |1 - L|^2 for the losses.
  bool grows_at_zero(const PatternGain& pattern_gain) const {
    const ZerosAtZero zeros = zeros_at_zero();
    return pattern_gain.zeros() > std::min(zeros.complement, zeros.innovation) + zeros.noise;
  }

  /// Positive exactly if string_stability() finds the platoon string stable, apart from the condition on the loss gain;
  /// needs no spectra. The smaller of 1 - rho(A), 1 - loss_feedback() and the least attenuation of |prod T^|^2; a
  /// positive margin is the least attenuation alone, which is smooth in the headway and in the losses.
  double gain_margin() const {
    if (!mean_square_stable()) return std::max(-1.0, 1.0 - std::max(spectral_radius(), loss_feedback()));
    const PatternGain pattern_gain = gain();
    const double least = pattern_gain.least(PatternGain::kSignAccuracy).value;
    return least > 0.0 && grows_at_zero(pattern_gain) ? 0.0 : least;
  }

private:
  double largest(double (Vehicle::*figure)() const) const {
    double found = 0.0;
    for (const Vehicle& vehicle : types) found = std::max(found, (vehicle.*figure)());
    return found;
  }
};

}  // namespace platoon
