#include "stochastic_platoon/math/numerics/stable_intervals.hpp"

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

namespace platoon {

namespace {

constexpr double kTurn = 3.0;
constexpr double kSteep = 1e6;  // larger margins are clipped to it

struct Sample {
  double place;
  double necessary;
  double rest;  ///< the margin; `necessary` itself where that is not positive
  bool stable() const { return necessary > 0.0 && rest > 0.0; }
  double margin() const { return std::min(rest, necessary); }
};

class MarginCurve {
public:
  MarginCurve(const StabilityMargin& margin, const StabilityMargin& necessary, double accuracy)
      : margin_(margin), necessary_(necessary), accuracy_(accuracy) {}

  Sample at(double place) const {
    const double necessary = necessary_ ? necessary_(place) : std::numeric_limits<double>::infinity();
    return {place, necessary, necessary > 0.0 ? margin_(place) : necessary};
  }

  /// The place where the margin comes nearest to zero or passes it, by golden section search. The margin at `middle`
  /// has the sign of its neighbours but lies nearer to zero.
  Sample extreme(Sample left, Sample middle, Sample right) const {
    const double towards_zero = middle.stable() ? -1.0 : 1.0;
    for (int iteration = 0; iteration < 60; ++iteration) {
      const bool right_is_wider = right.place - middle.place > middle.place - left.place;
      const Sample& wide = right_is_wider ? right : left;
      const Sample probe = at(middle.place + 0.381966 * (wide.place - middle.place));
      if (probe.stable() != middle.stable()) return probe;
      if (towards_zero * probe.margin() > towards_zero * middle.margin()) {
        (right_is_wider ? left : right) = middle;
        middle = probe;
      } else {
        (right_is_wider ? right : left) = probe;
      }
      if (right.place - left.place < 1e-9 * middle.place) break;
    }
    return middle;
  }

  /// The border between a stable and an unstable place, on its stable side. Each margin is followed alone: the smaller
  /// of both has a kink, where the search would fall back to bisection.
  double border(const Sample& stable, Sample unstable) const {
    if (!(unstable.necessary > 0.0)) {
      unstable = at(border_of(necessary_, {stable.place, stable.necessary}, {unstable.place, unstable.necessary}));
      if (unstable.stable()) return unstable.place;
    }
    return border_of([this](double place) { return at(place).rest; }, {stable.place, stable.rest},
                     {unstable.place, unstable.rest});
  }

private:
  struct End {
    double place, margin;
  };

  double border_of(const StabilityMargin& margin, const End& stable, const End& unstable) const {
    // Zero and NaN count as unstable, so the solver does not stop at an exact root; infinity ends its interpolation.
    const auto signed_margin = [](double value) {
      if (!(value > 0.0 || value < 0.0)) return -std::numeric_limits<double>::min();
      return std::clamp(value, -kSteep, kSteep);
    };
    const auto close = [this](double from, double to) { return to - from <= accuracy_ * to; };
    std::uintmax_t evaluations = 200;
    const bool ascending = stable.place < unstable.place;
    const End &a = ascending ? stable : unstable, &b = ascending ? unstable : stable;
    const std::pair<double, double> bracket =
        boost::math::tools::toms748_solve([&](double place) { return signed_margin(margin(place)); }, a.place, b.place,
                                          signed_margin(a.margin), signed_margin(b.margin), close, evaluations);
    return ascending ? bracket.first : bracket.second;
  }

  const StabilityMargin& margin_;
  const StabilityMargin& necessary_;
  double accuracy_;
};

// The samples at `places`, plus one wherever the margin changes sign between two samples of the same sign.
std::vector<Sample> samples_of(const MarginCurve& curve, const std::vector<double>& places) {
  std::vector<Sample> samples;
  samples.reserve(places.size());
  for (const double place : places) samples.push_back(curve.at(place));
  std::vector<Sample> found;
  for (std::size_t i = 1; i + 1 < samples.size(); ++i) {
    const Sample& here = samples[i];
    if (here.stable() != samples[i - 1].stable() || here.stable() != samples[i + 1].stable()) continue;
    // Between its neighbours, a margin that turns may approach zero by about its difference from them.
    const double size = std::abs(here.margin()), left = std::abs(samples[i - 1].margin()),
                 right = std::abs(samples[i + 1].margin());
    if (size > left || size > right || size > kTurn * (std::max(left, right) - size)) continue;
    const Sample extreme = curve.extreme(samples[i - 1], here, samples[i + 1]);
    if (extreme.stable() != here.stable()) found.push_back(extreme);
  }
  samples.insert(samples.end(), found.begin(), found.end());
  std::sort(samples.begin(), samples.end(), [](const Sample& a, const Sample& b) { return a.place < b.place; });
  return samples;
}

}  // namespace

std::vector<StableInterval> stable_intervals(const StabilityMargin& margin, const std::vector<double>& places,
                                             const StabilityMargin& necessary, double accuracy) {
  const MarginCurve curve(margin, necessary, accuracy);
  const std::vector<Sample> samples = samples_of(curve, places);
  std::vector<StableInterval> intervals;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!samples[i].stable()) continue;
    const double from = i == 0 ? samples[i].place : curve.border(samples[i], samples[i - 1]);
    while (i + 1 < samples.size() && samples[i + 1].stable()) ++i;
    const double to = i + 1 < samples.size() ? curve.border(samples[i], samples[i + 1]) : samples[i].place;
    intervals.push_back({from, to});
  }
  return intervals;
}

}  // namespace platoon
