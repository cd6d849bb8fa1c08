#include "stochastic_platoon/math/links/linked_pattern.hpp"
#include "stochastic_platoon/math/model/input.hpp"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <utility>

namespace platoon {

bool has_bursts(const PlatoonModel& model) {
  return any_link(model, [](const LinkModel& link) { return link.loss && !link.loss->is_independent(); });
}

std::optional<std::string> no_theory(const PlatoonModel& model) {
  if (has_limits(model)) return "vehicles have limits";
  std::optional<std::string> reason;
  any_link(model, [&reason](const LinkModel& link) { return (reason = link.no_theory()).has_value(); });
  return reason;
}

LinkedPattern::LinkedPattern(const PlatoonModel& model, const LinkedPattern& known) {
  if (const std::optional<std::string> reason = no_theory(model))
    throw std::invalid_argument("no theory, as " + *reason);
  if (!hears_predecessors_only(model))
    throw std::invalid_argument("no theory of this kind, as vehicles hear others than their predecessor");
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> place;  // (model type, that of the predecessor)
  const std::vector<std::size_t> model_types = type_order(model);
  const bool sends = has_radios(model);
  for (std::size_t j = 0, before = model_types.back(); j < model_types.size(); before = model_types[j++]) {
    const VehicleModel &vehicle = model.types[model_types[j]].vehicle, &predecessor = model.types[before].vehicle;
    const bool unlike = sends && !(predecessor.design->plant == vehicle.design->plant);
    const auto inserted = place.emplace(std::make_pair(model_types[j], unlike ? before : model_types[j]), types.size());
    if (inserted.second) {
      const LinkedVehicle* const same = types.size() < known.types.size() ? &known.types[types.size()] : nullptr;
      types.push_back(same != nullptr && same->is_of(vehicle)
                          ? *same
                          : LinkedVehicle(vehicle, same, unlike ? &predecessor : nullptr));
    }
    order.push_back(inserted.first->second);
  }
}

PatternGain LinkedPattern::gain() const {
  std::vector<RatedFactor> factors;
  for (std::size_t type = 0; type < types.size(); ++type) {
    factors.push_back(types[type].factor());
    factors.back().factor.count = static_cast<long double>(std::count(order.begin(), order.end(), type));
  }
  return PatternGain(std::move(factors));
}

ZerosAtZero LinkedPattern::zeros_at_zero() const {
  ZerosAtZero least{ZerosAtZero::kNone, ZerosAtZero::kNone, has_losses() ? 0 : ZerosAtZero::kNone};
  for (const LinkedVehicle& vehicle : types) {
    const ZerosAtZero zeros = vehicle.zeros_at_zero();
    least.complement = std::min(least.complement, zeros.complement);
    least.innovation = std::min(least.innovation, zeros.innovation);
    least.noise = std::min(least.noise, zeros.noise);
  }
  if (least.noise == ZerosAtZero::kNone) least.noise = 0;  // as for any noise, however small
  return least;
}

bool LinkedPattern::grows_at_zero(const PatternGain& pattern_gain) const {
  const ZerosAtZero zeros = zeros_at_zero();
  return pattern_gain.zeros() > std::min(zeros.complement, zeros.innovation) + zeros.noise;
}

double LinkedPattern::gain_margin() const {
  if (!mean_square_stable()) return std::max(-1.0, 1.0 - std::max(spectral_radius(), loss_feedback()));
  const PatternGain pattern_gain = gain();
  const double least = pattern_gain.least(PatternGain::kSignAccuracy).value;
  return least > 0.0 && grows_at_zero(pattern_gain) ? 0.0 : least;
}

double LinkedPattern::largest(double (LinkedVehicle::*figure)() const) const {
  double found = 0.0;
  for (const LinkedVehicle& vehicle : types) found = std::max(found, (vehicle.*figure)());
  return found;
}

bool LinkedPattern::any(bool (LinkedVehicle::*condition)() const) const {
  return std::any_of(types.begin(), types.end(),
                     [condition](const LinkedVehicle& vehicle) { return (vehicle.*condition)(); });
}

}  // namespace platoon
