#include "stochastic_platoon/math/string/burst_pattern.hpp"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <utility>

#include "stochastic_platoon/math/numerics/text.hpp"

namespace platoon {

namespace {

VehicleModel without_losses(VehicleModel vehicle) {
  if (vehicle.feed_forward)
    throw std::invalid_argument("inputs: a radio: must be absent for the theory of losses in bursts");
  vehicle.link.loss.reset();
  return vehicle;
}

bool alternates(const LossModel& loss) {
  return !(loss.after_loss() - loss.after_arrival() > -1.0);
}

}  // namespace

BurstVehicle::BurstVehicle(const VehicleModel& vehicle, const BurstVehicle* known)
    : vehicle_(vehicle),
      plain_(without_losses(vehicle), known == nullptr ? nullptr : &known->plain_),
      second_moment_radius_(vehicle.link.loses() ? platoon::second_moment_radius(*vehicle.link.loss) : 0.0) {
  if (!vehicle.link.loses() || !(second_moment_radius_ < 1.0)) return;
  losses_ = known != nullptr && known->losses_ && known->vehicle_.link.loss == vehicle.link.loss
                ? known->losses_
                : std::make_shared<BurstLink>(*vehicle.link.loss);
}

double BurstVehicle::lag() const {
  return static_cast<double>(vehicle_.link.delay) + (losses_ ? losses_->lag() : 0.0);
}

RatedFactor BurstVehicle::factor() const {
  RatedFactor rated = plain_.factor();
  if (!losses_) return rated;
  GainFactor& factor = rated.factor;
  const GainFactor& link = losses_->factor();
  factor.poles.insert(factor.poles.end(), link.poles.begin(), link.poles.end());
  factor.zeros.insert(factor.zeros.end(), link.zeros.begin(), link.zeros.end());
  return rated;
}

ZerosAtZero BurstVehicle::zeros_at_zero() const {
  ZerosAtZero zeros = plain_.zeros_at_zero();
  if (!losses_) return zeros;
  LinkModel independent = vehicle_.link;  // 1 - L does not depend on the chain
  independent.loss->mean_burst.reset();
  zeros.innovation = LinkFilter(independent, vehicle_.noise_variance).surprise_zeros();
  zeros.complement = std::min(zeros.complement, zeros.innovation);
  return zeros;
}

PatternGain BurstPattern::gain() const {
  std::vector<RatedFactor> factors;
  for (std::size_t type = 0; type < types.size(); ++type) {
    factors.push_back(types[type].factor());
    factors.back().factor.count = static_cast<long double>(std::count(order.begin(), order.end(), type));
  }
  return PatternGain(std::move(factors));
}

bool BurstPattern::mean_square_stable() const {
  return std::all_of(types.begin(), types.end(), [](const BurstVehicle& v) { return v.mean_square_stable(); });
}

bool BurstPattern::has_losses() const {
  return std::any_of(types.begin(), types.end(), [](const BurstVehicle& v) { return v.losses() != nullptr; });
}

BurstPattern burst_pattern(const PlatoonModel& model, const BurstPattern& known) {
  BurstPattern found;
  std::map<std::size_t, std::size_t> place;  // model type -> index in found.types
  for (const std::size_t type : type_order(model)) {
    const auto inserted = place.emplace(type, found.types.size());
    if (inserted.second) {
      const VehicleModel& vehicle = model.types[type].vehicle;
      const BurstVehicle* const before =
          found.types.size() < known.types.size() ? &known.types[found.types.size()] : nullptr;
      const bool unchanged =
          before != nullptr && before->vehicle().headway == vehicle.headway && before->vehicle().link == vehicle.link;
      found.types.push_back(unchanged ? *before : BurstVehicle(vehicle, before));
    }
    found.order.push_back(inserted.first->second);
  }
  return found;
}

bool has_bursts(const PlatoonModel& model) {
  return any_link(model, [](const LinkModel& link) { return link.loss && !link.loss->is_independent(); });
}

std::optional<std::string> no_burst_theory(const PlatoonModel& model) {
  if (depends_on_gap(model)) return "losses depend on the gap";
  const LossModel* recorded = nullptr;
  any_link(model, [&](const LinkModel& link) {
    if (link.loses() && link.loss->trace) recorded = &*link.loss;
    return recorded != nullptr;
  });
  if (recorded != nullptr)
    return formatted(
        "losses follow a recorded trace, of loss probability %.6g and mean burst %.6g (random losses with these two have a theory)",
        recorded->probability, *recorded->mean_burst);
  if (has_feed_forward(model)) return "losses come in bursts in a string with radios";
  if (any_link(model, [](const LinkModel& link) { return link.loses() && alternates(*link.loss); }))
    return "losses and arrivals strictly alternate";
  return std::nullopt;
}

}  // namespace platoon
