#include "stochastic_platoon/theory/critical_loss.hpp"

#include "stochastic_platoon/theory/linked_string.hpp"

namespace platoon {

std::optional<StableLosses> stable_losses(const PlatoonModel& model) {
  if (!model.link.loss) return std::nullopt;
  constexpr int kSamples = 100;
  std::vector<double> samples;
  samples.reserve(kSamples);
  for (int i = 0; i < kSamples; ++i) samples.push_back(0.01 * i);
  const auto margin = [&model](double probability) {
    PlatoonModel varied = model;
    varied.link.loss->probability = probability;
    varied.link.loss->mean_burst
        .reset();  // which is that of independent losses, at the model's own probability
    return linked_string_margin(varied);
  };
  StableLosses losses{stable_intervals(margin, samples), {}};
  if (losses.intervals.empty() || losses.intervals.front().from > 0.0) return losses;
  if (losses.intervals.front().to < samples.back()) losses.critical = losses.intervals.front().to;
  return losses;
}

}  // namespace platoon
