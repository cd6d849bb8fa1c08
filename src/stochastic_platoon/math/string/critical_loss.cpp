#include "stochastic_platoon/math/string/critical_loss.hpp"

#include <algorithm>
#include <utility>

#include "stochastic_platoon/math/links/linked_pattern.hpp"
#include "stochastic_platoon/math/string/varied_margins.hpp"

namespace platoon {

namespace {

// b / (1 + b) of the shortest mean burst, and less where arrivals and losses would alternate; 0.99 without bursts.
double largest_probability(const PlatoonModel& model) {
  double largest = 0.99;
  for (const VehicleType& type : model.types) {
    const std::optional<LossModel>& loss = type.vehicle.varied_link().loss;
    if (!type.inherited.loss_probability || !loss->mean_burst) continue;
    const double burst = *loss->mean_burst;
    largest = std::min(largest, burst > 1.0 ? burst / (1.0 + burst) : 0.499);
  }
  return largest;
}

}  // namespace

std::optional<StableLosses> stable_losses(const PlatoonModel& given) {
  if (const auto reason = no_theory(given)) throw std::invalid_argument("no theory, as " + *reason);
  const std::optional<LossModel>& own_loss = given.default_vehicle().varied_link().loss;
  if (own_loss && own_loss->markov) return std::nullopt;
  const PlatoonModel model = with_loss_stage(given);
  const std::vector<std::string> types = types_with_default(model, &Inherited::loss_probability);
  if (types.empty()) return std::nullopt;
  const double own = model.default_vehicle().varied_link().loss->probability;
  // In hundredths. Where others than predecessors are heard, each sample takes a verdict of the whole string.
  const int stride = given.default_vehicle().varied_link().loss && hears_predecessors_only(given) ? 1 : 5;
  const double largest = largest_probability(model);
  std::vector<double> samples;
  for (int i = 0; i < 99 && 0.01 * i < largest; i += stride) samples.push_back(0.01 * i);
  samples.push_back(largest);
  StableLosses losses{{}, {}, types, largest};
  const auto place = std::lower_bound(samples.begin(), samples.end(), own);
  if (place != samples.end() && *place != own) samples.insert(place, own);
  const VariedMargins margins =
      varied_margins([&model](double probability) { return with_loss(model, probability); }, own);
  losses.intervals = margins.intervals(samples);
  if (losses.intervals.empty() || losses.intervals.front().from > 0.0) return losses;
  if (losses.intervals.front().to < samples.back()) losses.critical = losses.intervals.front().to;
  return losses;
}

}  // namespace platoon
