#include "stochastic_platoon/math/string/critical_headway.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>

#include "stochastic_platoon/math/string/varied_margins.hpp"

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

/// Whether every longer headway of a stable one is stable: without losses, the headway enters |prod T^| only by the
/// filters 1 / |H|, which fall at every frequency as it grows, and the poles of their loops do not depend on it.
bool is_monotone(const PlatoonModel& model) {
  return !loses(model) && std::all_of(model.types.begin(), model.types.end(), [](const VehicleType& type) {
    return !type.inherited.headway || type.vehicle.design->headway_filter;
  });
}

}  // namespace

HeadwayRange headways_about(double headway) {
  HeadwayRange range;
  const double decades = std::log(range.to / range.from);
  range.from = std::min(range.from, headway / 100.0);
  range.to = std::max(range.to, 100.0 * headway);
  range.samples = static_cast<int>(std::ceil(range.samples * std::log(range.to / range.from) / decades));
  range.also = headway;
  return range;
}

StableHeadways stable_headways(const StabilityMargin& margin, const HeadwayRange& range,
                               const StabilityMargin& necessary, double accuracy) {
  if (!(range.from > 0.0 && range.from < range.to && std::isfinite(range.to))) {
    throw std::invalid_argument("headway range: " + std::to_string(range.from) + " to " + std::to_string(range.to) +
                                ": must be 0 < from < to, finite");
  }
  if (range.samples < 2) {
    throw std::invalid_argument("samples: " + std::to_string(range.samples) + ": must be >= 2");
  }
  const std::vector<double> samples = samples_of(range);
  StableHeadways result{stable_intervals(margin, samples, necessary, accuracy), {}, range, {}};
  if (!result.intervals.empty() && result.intervals.back().to == samples.back())
    result.critical = result.intervals.back().from;
  return result;
}

std::optional<StableHeadways> stable_headways(const PlatoonModel& model) {
  const std::vector<std::string> types = types_with_default(model, &Inherited::headway);
  const bool designed = std::all_of(model.types.begin(), model.types.end(), [](const VehicleType& type) {
    return !type.inherited.headway || type.vehicle.design;
  });
  if (!designed || types.empty() || model.default_vehicle().constant_spacing) return std::nullopt;
  const bool plain = hears_predecessors_only(model);
  const double own = model.default_vehicle().headway;
  const VariedMargins margins = varied_margins([&model](double headway) { return with_headway(model, headway); }, own);
  HeadwayRange range = headways_about(own);
  if (!plain) {
    range.samples = 32;  // each takes a verdict of the whole string
  } else if (is_monotone(model)) {
    range.samples = 8;  // for the search of the one end
  }
  StableHeadways found = stable_headways(margins.losses, range, margins.gain, margins.accuracy);
  found.types = types;
  return found;
}

}  // namespace platoon
