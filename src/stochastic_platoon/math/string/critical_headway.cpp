#include "stochastic_platoon/math/string/critical_headway.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>

#include "stochastic_platoon/math/string/burst_string.hpp"
#include "stochastic_platoon/math/string/linked_string.hpp"
#include "stochastic_platoon/math/string/loop_spectrum.hpp"
#include "stochastic_platoon/math/string/pattern_gain.hpp"
#include "stochastic_platoon/math/string/varied_pattern.hpp"

namespace platoon {

namespace {

std::vector<double> samples_of(const HeadwayRange& range) {
  std::vector<double> samples;
  const double ratio = std::log(range.to / range.from);
  for (int i = 0; i < range.samples; ++i) {
    const bool last = i + 1 == range.samples;
    samples.push_back(last ? range.to : range.from * std::exp(ratio * i / (range.samples - 1)));
  }
  if (range.also && *range.also > range.from && *range.also < range.to) {
    const auto place = std::lower_bound(samples.begin(), samples.end(), *range.also);
    if (*place != *range.also) samples.insert(place, *range.also);
  }
  return samples;
}

template <class Pattern>
StableHeadways stable_headways(VariedPattern<Pattern> varied, const HeadwayRange& range) {
  return stable_headways(varied.losses(), range, varied.gain());
}

}  // namespace

double string_margin(const ClosedLoop& loop, double headway) {
  if (!loop.parts) LoopSpectrum(loop, headway);  // throws without double integral action
  const double decay = 1.0 - spectral_radius(loop);
  if (!(decay > 0.0)) return decay;
  const PatternGain gain({rated_factor(loop)});
  const LeastMargin least = gain.least();
  const auto is_flat = [&] {  // then |T| < 1 is not sufficient
    if (loop.parts) return gain.zeros() > *loop.integrators;
    const LoopSpectrum spectrum(loop, headway);
    return spectrum.margin_zeros() > spectrum.sensitivity_zeros();
  };
  const bool flat = gain.zeros() > 2 && is_flat();
  return std::min(decay, flat ? std::min(least.value, 0.0) : least.value);
}

HeadwayRange headways_about(double headway) {
  HeadwayRange range;
  const double decades = std::log(range.to / range.from);
  range.from = std::min(range.from, headway / 100.0);
  range.to = std::max(range.to, 100.0 * headway);
  range.samples = static_cast<int>(std::ceil(range.samples * std::log(range.to / range.from) / decades));
  range.also = headway;
  return range;
}

StableHeadways stable_headways(const HeadwayLaw& law, const HeadwayRange& range) {
  if (!(range.from > 0.0 && range.from < range.to && std::isfinite(range.to))) {
    throw std::invalid_argument("headway range: " + std::to_string(range.from) + " to " + std::to_string(range.to) +
                                ": must be 0 < from < to, finite");
  }
  if (range.samples < 2) {
    throw std::invalid_argument("samples: " + std::to_string(range.samples) + ": must be >= 2");
  }
  return stable_headways(
      [&law](double headway) {
        // A headway without a loop of double integral action counts as unstable.
        try {
          return string_margin(law(headway), headway);
        } catch (const std::invalid_argument&) {
          return -1.0;
        }
      },
      range);
}

StableHeadways stable_headways(const StabilityMargin& margin, const HeadwayRange& range,
                               const StabilityMargin& necessary) {
  const std::vector<double> samples = samples_of(range);
  StableHeadways result{stable_intervals(margin, samples, necessary), {}, range, {}};
  if (!result.intervals.empty() && result.intervals.back().to == samples.back())
    result.critical = result.intervals.back().from;
  return result;
}

std::optional<StableHeadways> stable_headways(const PlatoonModel& model) {
  const std::vector<std::string> types = types_with_default(model, &Inherited::headway);
  const bool designed = std::all_of(model.types.begin(), model.types.end(), [](const VehicleType& type) {
    return !type.inherited.headway || type.vehicle.design;
  });
  if (!designed || types.empty()) return std::nullopt;
  const double own = model.default_vehicle().headway;
  const auto at = [&model](double headway) { return with_headway(model, headway); };
  HeadwayRange range = headways_about(own);
  StableHeadways found;
  if (is_papers(model) && !model.default_vehicle().loop.parts) {
    found = stable_headways([&model](double headway) { return close_loop(*model.default_vehicle().design, headway); },
                            range);
  } else if (has_bursts(model)) {
    found = stable_headways(VariedPattern<BurstPattern>(at, own, burst_pattern, burst_gain_margin, burst_loss_margin),
                            range);
  } else {
    found = stable_headways(
        VariedPattern<LinkedPattern>(at, own, linked_pattern, linked_gain_margin, linked_loss_margin), range);
  }
  found.types = types;
  return found;
}

}  // namespace platoon
