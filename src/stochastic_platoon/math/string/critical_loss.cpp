#include "stochastic_platoon/math/string/critical_loss.hpp"

#include "stochastic_platoon/math/string/linked_string.hpp"

namespace platoon {

namespace {

// If the default vehicle's link has no loss stage, gives it and every such link without one a stage that holds the last
// value.
PlatoonModel with_loss_stage(PlatoonModel model) {
  if (varied_link(model.default_vehicle()).loss) return model;
  const bool radio = model.default_vehicle().feed_forward.has_value();
  for (VehicleType& type : model.types) {
    if (varied_link(type.vehicle).loss || type.vehicle.feed_forward.has_value() != radio) continue;
    varied_link(type.vehicle).loss = LossModel{};
    type.inherited.loss_probability = true;
  }
  return model;
}

}  // namespace

std::optional<StableLosses> stable_losses(const PlatoonModel& given) {
  const PlatoonModel model = with_loss_stage(given);
  const std::vector<std::string> types = types_with_default(model, &Inherited::loss_probability);
  if (types.empty()) return std::nullopt;
  const int stride = varied_link(given.default_vehicle()).loss ? 1 : 5;  // in hundredths
  std::vector<double> samples;
  for (int i = 0; i < 99; i += stride) samples.push_back(0.01 * i);
  samples.push_back(0.99);
  const LinkedPattern pattern =
      linked_pattern(with_loss(model, varied_link(model.default_vehicle()).loss->probability));
  const auto at = [&](double probability) { return linked_pattern(with_loss(model, probability), pattern); };
  StableLosses losses{
      stable_intervals([&](double probability) { return linked_string_margin(at(probability)); }, samples,
                       [&](double probability) { return linked_gain_margin(at(probability)); }),
      {},
      types};
  if (losses.intervals.empty() || losses.intervals.front().from > 0.0) return losses;
  if (losses.intervals.front().to < samples.back()) losses.critical = losses.intervals.front().to;
  return losses;
}

}  // namespace platoon
