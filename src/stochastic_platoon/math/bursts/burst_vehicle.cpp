#include "stochastic_platoon/math/bursts/burst_vehicle.hpp"

#include <algorithm>
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

}  // namespace

BurstVehicle::BurstVehicle(const VehicleModel& vehicle, const BurstVehicle* known, const VehicleModel* before)
    : vehicle_(vehicle),
      plain_(without_losses(vehicle), known == nullptr ? nullptr : &known->plain_, before),
      loss_feedback_(vehicle.link.loses() ? platoon::second_moment_radius(*vehicle.link.loss) : 0.0) {
  if (!vehicle.link.loses() || !(loss_feedback_ < 1.0)) return;
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
  independent.loss = LossModel{vehicle_.link.loss->probability, {}, vehicle_.link.loss->predictor};
  zeros.innovation = LinkFilter(independent, vehicle_.noise_variance).surprise_zeros();
  zeros.complement = std::min(zeros.complement, zeros.innovation);
  return zeros;
}

bool BurstVehicle::is_of(const VehicleModel& vehicle) const {
  return vehicle.headway == vehicle_.headway && vehicle.link == vehicle_.link;
}

namespace {

// " (...)": the random losses that have a theory in place of the recorded ones; empty if none have.
std::string theory_of_random_losses(PlatoonModel model) {
  const auto change = [&model](const auto& changed) {
    for (VehicleType& type : model.types) {
      for (LinkModel* link :
           {&type.vehicle.link, type.vehicle.feed_forward ? &type.vehicle.feed_forward->link : nullptr}) {
        if (link != nullptr && link->loss && link->loss->trace) changed(*link->loss);
      }
    }
  };
  const auto has_theory = [&model] { return !has_bursts(model) || !no_burst_theory(model); };
  PlatoonModel recorded = model;
  change([](LossModel& loss) { loss.trace.reset(); });
  if (has_theory()) return " (random losses with these two have a theory)";
  model = std::move(recorded);
  change([](LossModel& loss) {
    loss.trace.reset();
    loss.mean_burst.reset();
  });
  return has_theory() ? " (independent losses of this probability have a theory)" : "";
}

}  // namespace

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
    return formatted("losses follow a recorded trace, of loss probability %.6g and mean burst %.6g",
                     recorded->probability, *recorded->mean_burst) +
           theory_of_random_losses(model);
  if (has_feed_forward(model)) return "losses come in bursts in a string with radios";
  if (any_link(model, [](const LinkModel& link) { return link.loses() && link.loss->alternates(); }))
    return "losses and arrivals alternate (mean_burst: 1 at a probability of 0.5), so that no variance settles";
  return std::nullopt;
}

}  // namespace platoon
