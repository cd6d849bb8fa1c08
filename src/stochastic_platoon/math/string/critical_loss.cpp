#include "stochastic_platoon/math/string/critical_loss.hpp"

#include "stochastic_platoon/math/string/linked_string.hpp"

namespace platoon {

namespace {

// If the default link has no loss stage, gives it and every type without one a stage that holds the last position.
PlatoonModel with_loss_stage(PlatoonModel model) {
  if (model.default_vehicle().link.loss) return model;
  for (VehicleType& type : model.types) {
    if (type.vehicle.link.loss) continue;
    type.vehicle.link.loss = LossModel{};
    type.inherited.loss_probability = true;
  }
  return model;
}

}  // namespace

std::optional<StableLosses> stable_losses(const PlatoonModel& given) {
  const PlatoonModel model = with_loss_stage(given);
  const std::vector<std::string> types = types_with_default(model, &Inherited::loss_probability);
  if (types.empty()) return std::nullopt;
  const int stride = given.default_vehicle().link.loss ? 1 : 5;  // in hundredths
  std::vector<double> samples;
  for (int i = 0; i < 99; i += stride) samples.push_back(0.01 * i);
  samples.push_back(0.99);
  const LinkedPattern pattern = linked_pattern(with_loss(model, model.default_vehicle().link.loss->probability));
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
