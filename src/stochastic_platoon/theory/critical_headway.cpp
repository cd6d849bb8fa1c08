#include "stochastic_platoon/theory/critical_headway.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>

#include "stochastic_platoon/theory/least_margin.hpp"
#include "stochastic_platoon/theory/loop_spectrum.hpp"

namespace platoon {

namespace {

struct Sample {
  double headway;
  double margin;
  bool stable() const { return margin > 0.0; }
};

class MarginCurve {
public:
  explicit MarginCurve(const HeadwayLaw& law) : law_(law) {}

  /// A headway that leaves no loop with double integral action is an unstable one.
  Sample at(double headway) const {
    try {
      return {headway, string_margin(law_(headway), headway)};
    } catch (const std::invalid_argument&) {
      return {headway, -1.0};
    }
  }

  /// Where the margin of the middle sample, which has the sign of its neighbours but lies nearer to zero,
  /// comes nearest to zero or passes it; golden section search.
  Sample extreme(Sample left, Sample middle, Sample right) const {
    const double towards_zero = middle.stable() ? -1.0 : 1.0;
    for (int iteration = 0; iteration < 60; ++iteration) {
      const bool right_is_wider = right.headway - middle.headway > middle.headway - left.headway;
      const Sample& wide = right_is_wider ? right : left;
      const Sample probe = at(middle.headway + 0.381966 * (wide.headway - middle.headway));
      if (probe.stable() != middle.stable()) return probe;
      if (towards_zero * probe.margin > towards_zero * middle.margin) {
        (right_is_wider ? left : right) = middle;
        middle = probe;
      } else {
        (right_is_wider ? right : left) = probe;
      }
      if (right.headway - left.headway < 1e-9 * middle.headway) break;
    }
    return middle;
  }

  /// The border between a stable and an unstable headway, on its stable side.
  double border(Sample a, Sample b) const {
    while (std::abs(b.headway - a.headway) > 1e-13 * b.headway) {
      const Sample middle = at(a.headway + (b.headway - a.headway) / 2.0);
      if (middle.headway == a.headway || middle.headway == b.headway) break;
      (middle.stable() == a.stable() ? a : b) = middle;
    }
    return a.stable() ? a.headway : b.headway;
  }

private:
  const HeadwayLaw& law_;
};

std::vector<Sample> samples_of(const MarginCurve& curve, const HeadwayRange& range) {
  std::vector<Sample> samples;
  const double ratio = std::log(range.to / range.from);
  for (int i = 0; i < range.samples; ++i) {
    const bool last = i + 1 == range.samples;
    samples.push_back(curve.at(last ? range.to : range.from * std::exp(ratio * i / (range.samples - 1))));
  }
  if (range.also && *range.also > range.from && *range.also < range.to) {
    const Sample own = curve.at(*range.also);
    const auto place = std::find_if(samples.begin(), samples.end(),
                                    [&](const Sample& s) { return s.headway >= own.headway; });
    if (place->headway != own.headway) samples.insert(place, own);
  }
  std::vector<Sample> found;
  for (std::size_t i = 1; i + 1 < samples.size(); ++i) {
    const Sample& here = samples[i];
    if (here.stable() != samples[i - 1].stable() || here.stable() != samples[i + 1].stable()) continue;
    const double size = std::abs(here.margin);
    if (size > std::abs(samples[i - 1].margin) || size > std::abs(samples[i + 1].margin)) continue;
    const Sample extreme = curve.extreme(samples[i - 1], here, samples[i + 1]);
    if (extreme.stable() != here.stable()) found.push_back(extreme);
  }
  samples.insert(samples.end(), found.begin(), found.end());
  std::sort(samples.begin(), samples.end(),
            [](const Sample& a, const Sample& b) { return a.headway < b.headway; });
  return samples;
}

}  // namespace

double string_margin(const ClosedLoop& loop, double headway) {
  const LoopSpectrum spectrum(loop, headway);
  const double decay = 1.0 - spectral_radius(loop);
  const LeastMargin least = least_margin(spectrum);
  const bool flat = spectrum.margin_zeros() > spectrum.sensitivity_zeros();  // |T| < 1 is then not enough
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
    throw std::invalid_argument("headway range: " + std::to_string(range.from) + " to " +
                                std::to_string(range.to) + ": must be 0 < from < to, finite");
  }
  if (range.samples < 2) {
    throw std::invalid_argument("samples: " + std::to_string(range.samples) + ": must be >= 2");
  }
  const MarginCurve curve(law);
  const std::vector<Sample> samples = samples_of(curve, range);
  StableHeadways result{{}, {}, range};
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!samples[i].stable()) continue;
    const double from = i == 0 ? samples[i].headway : curve.border(samples[i - 1], samples[i]);
    while (i + 1 < samples.size() && samples[i + 1].stable()) ++i;
    const double to = i + 1 < samples.size() ? curve.border(samples[i], samples[i + 1]) : samples[i].headway;
    result.intervals.push_back({from, to});
  }
  if (!samples.empty() && samples.back().stable()) result.critical = result.intervals.back().from;
  return result;
}

}  // namespace platoon
