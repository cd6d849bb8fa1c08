#include "stochastic_platoon/math/string/hearing_signals.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>

#include "stochastic_platoon/math/model/hearing_loop.hpp"
#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/numerics/special_values.hpp"
#include "stochastic_platoon/math/string/hearing_limit.hpp"
#include "stochastic_platoon/math/string/hearing_string.hpp"
#include "stochastic_platoon/math/string/settled_hearing.hpp"
#include "stochastic_platoon/math/string/stationary_variance.hpp"

namespace platoon {

namespace {

using Pair = HearingSpectra::Pair;
using Window = HearingSpectra::Window;

// Means behind so many followers are those of an endless string, if they change by less from pattern to pattern [m]:
// they fall into place like the powers of a matrix, or grow with the number of vehicles, as where vehicles of unlike
// standstill distances keep a multiple of their own from the leader.
constexpr std::size_t kFarFollowers = 1000;
constexpr double kInPlace = 1e-8;

/// What a signal takes of the own position at each frequency, and 1 - 1/z.
struct Filters {
  Eigen::ArrayXcd own, moved;
};

Filters filters_of(const Signal& signal, const PlatoonModel& model, std::size_t follower, const HearingSpectra& spectra,
                   Eigen::Index count) {
  Filters filters{Eigen::ArrayXcd(count), Eigen::ArrayXcd(count)};
  std::optional<HearingLoop> loop;
  if (signal.is_input) loop.emplace(vehicle(model, follower), follower, model.sample_period);
  for (Eigen::Index k = 0; k < count; ++k) {
    const CirclePoint& point = spectra.points()[static_cast<std::size_t>(k)];
    const std::complex<double> moved(point.from_one() * std::conj(1.0L + point.from_one()));
    filters.moved(k) = moved;
    filters.own(k) =
        loop ? std::complex<double>(loop->at(point).sent)
             : (signal.order > 0 ? signal.factor * std::pow(moved, signal.order) : 0.0) - (signal.relative ? 1.0 : 0.0);
  }
  return filters;
}

// Variance and change of each signal.
std::vector<double> moments_of(const std::vector<Signal>& signals, const PlatoonModel& model, std::size_t follower,
                               const HearingSpectra& spectra, const Pair& pair) {
  std::vector<double> moments;
  for (const Signal& signal : signals) {
    const Filters filters = filters_of(signal, model, follower, spectra, pair.own.size());
    moments.push_back(pair.variance(filters.own, signal.relative));
    const Eigen::ArrayXd turned = filters.moved.abs2();
    const Pair changes{turned * pair.own, turned * pair.predecessor, turned * pair.cross};
    moments.push_back(changes.variance(filters.own, signal.relative));
  }
  return moments;
}

}  // namespace

std::vector<StationarySignal> hearing_signals(const PlatoonModel& model, const std::vector<std::string>& names,
                                              std::size_t followers, bool string_stable) {
  const std::vector<double> none(followers, kNaN);
  std::vector<StationarySignal> result(names.size(), StationarySignal{{none, none, none}, std::nullopt});
  const std::vector<double> errors = stationary_means(model, followers);
  if (std::isnan(errors.front())) return result;
  const auto signals_from = [&](std::size_t first, std::size_t count) {
    std::vector<std::vector<Signal>> signals;
    for (std::size_t i = first; i < first + count; ++i) signals.push_back(signals_of(model, names, i).requested);
    return signals;
  };
  try {
    const std::vector<std::vector<Signal>> signals = signals_from(1, followers);
    const std::vector<double> values = settled_hearing(model, [&](const HearingSpectra& spectra) {
      Window window = spectra.nothing();
      std::vector<double> moments;
      for (std::size_t i = 1; i <= followers; ++i) {
        const Pair pair = spectra.advance(i, spectra.added(i, window), window);
        const std::vector<double> own = moments_of(signals[i - 1], model, i, spectra, pair);
        moments.insert(moments.end(), own.begin(), own.end());
      }
      return moments;
    });
    for (std::size_t s = 0; s < names.size(); ++s)
      result[s].followers = stationary_moments(model, signals, s, 1, errors, values);
    if (!string_stable) return result;
    const std::size_t period = type_order(model).size();
    const std::size_t far = (kFarFollowers / period + 1) * period;
    const std::vector<std::vector<Signal>> at_places = signals_from(far + 1, period);
    const std::vector<double> limits = settled_hearing(model, [&](const HearingSpectra& spectra) {
      return hearing_limits(spectra, period, [&](std::size_t follower, const Pair& pair) {
        return moments_of(at_places[(follower - 1) % period], model, follower, spectra, pair);
      });
    });
    const std::vector<double> means = stationary_means(model, far + 2 * period);
    std::vector<double> settled;
    for (std::size_t i = far; i < far + period; ++i)
      settled.push_back(std::abs(means[i + period] - means[i]) < kInPlace ? means[i] : kNaN);
    for (std::size_t s = 0; s < names.size(); ++s)
      result[s].limit = stationary_moments(model, at_places, s, far + 1, settled, limits);
  } catch (const NarrowSpectra&) {
    // The moments that were not computed stay NaN, and the limit is absent.
  }
  return result;
}

std::vector<std::vector<double>> hearing_variances_by_input(const PlatoonModel& model, std::size_t followers) {
  std::size_t inputs = 0;
  for (const VehicleModel& of : pattern(model)) inputs = std::max(inputs, of.inputs.size());
  std::vector<std::vector<double>> shares(followers, std::vector<double>(inputs, kNaN));
  if (std::isnan(stationary_means(model, followers).front())) return shares;
  const std::vector<double> values = settled_hearing(model, [&](const HearingSpectra& spectra) {
    Window all = spectra.nothing();
    std::vector<Window> of_input(inputs, all);
    std::vector<double> variances;
    for (std::size_t i = 1; i <= followers; ++i) {
      std::vector<Eigen::ArrayXd> added = spectra.added_by_input(i, all);
      added.resize(inputs, Eigen::ArrayXd::Zero(added.front().size()));
      for (std::size_t n = 0; n < inputs; ++n)
        variances.push_back(spectra.error_variance(i, spectra.advance(i, added[n], of_input[n])));
      spectra.advance(i, spectra.added(i, all), all);
    }
    return variances;
  });
  for (std::size_t i = 0; i < followers; ++i)
    std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(i * inputs), inputs, shares[i].begin());
  return shares;
}

}  // namespace platoon
