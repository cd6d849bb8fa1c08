#include "stochastic_platoon/math/string/stationary_signals.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "stochastic_platoon/math/model/linear_model.hpp"
#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/numerics/special_values.hpp"
#include "stochastic_platoon/math/string/settled_hearing.hpp"
#include "stochastic_platoon/math/string/stationary_variance.hpp"

namespace platoon {

namespace {

// Means behind so many followers are those of an endless string, if they change by less from pattern to pattern [m]:
// they fall into place like the powers of a matrix, or grow with the number of vehicles, as where vehicles of unlike
// standstill distances keep a multiple of their own from the leader.
constexpr std::size_t kFarFollowers = 1000;
constexpr double kInPlace = 1e-8;

/// Variance and change of every signal of one follower of the walk after the other.
std::vector<double> moments_along(StringWalk& walk, const SignalLists& signals) {
  std::vector<double> values;
  for (const std::vector<Signal>& of_follower : signals) {
    walk.pass(sum_of(walk.added()));
    for (const Signal& signal : of_follower) {
      for (const double value : walk.moments(signal)) values.push_back(std::isnan(value) ? kInfinity : value);
    }
  }
  return values;
}

/// Those of signal `index` of the followers first, first + 1, ..., whose signals, mean tracking errors at the leader's
/// last speed, and moments_along() are given.
StationaryMoments stationary_moments(const PlatoonModel& model, const SignalLists& signals, std::size_t index,
                                     std::size_t first, const std::vector<double>& errors,
                                     const std::vector<double>& values) {
  const double speed = metres_per_step(model);
  StationaryMoments moments;
  for (std::size_t i = 0; i < signals.size(); ++i) {
    const Signal& signal = signals[i][index];
    const VehicleModel& own = vehicle(model, first + i);
    double mean = signal.own.order == 1 ? signal.own.factor * speed : 0.0;
    if (signal.is_input) mean = steady_input(own, speed);
    if (signal.of_distance() != 0.0)
      mean += signal.of_distance() * (own.standstill_distance + own.headway * speed + errors[i]) - signal.offset;
    moments.mean.push_back(mean);
    const std::size_t at = 2 * (i * signals[i].size() + index);
    moments.variance.push_back(values[at]);
    moments.change.push_back(values[at + 1]);
  }
  return moments;
}

/// Sets the limits that exist. Where one does not, its pole at w = 0 would keep the quadrature from settling.
void add_limits(const StringTheory& theory, const std::vector<std::string>& names,
                std::vector<StationarySignal>& result) {
  const PlatoonModel& model = theory.model();
  const std::size_t period = type_order(model).size(), far = (kFarFollowers / period + 1) * period;
  const SignalLists at_places = signal_lists(model, names, period, far + 1);
  const int zeros = theory.zeros_at_zero();
  std::vector<std::size_t> bounded;
  for (std::size_t s = 0; s < names.size(); ++s) {
    const Signal& signal = at_places[0][s];
    if (zeros <= std::max(signal.is_relative() ? signal.apart.order + 1 : signal.own.order, 1)) bounded.push_back(s);
  }
  if (bounded.empty()) return;
  SignalLists kept(period);
  for (std::size_t p = 0; p < period; ++p) {
    for (const std::size_t s : bounded) kept[p].push_back(at_places[p][s]);
  }
  const std::vector<double> limits =
      theory.settled_behind_endless([&kept](StringWalk& walk) { return moments_along(walk, kept); });
  const std::vector<double> means = theory.means(far + 2 * period);
  std::vector<double> settled;
  for (std::size_t i = far; i < far + period; ++i)
    settled.push_back(std::abs(means[i + period] - means[i]) < kInPlace ? means[i] : kNaN);
  for (std::size_t index = 0; index < bounded.size(); ++index)
    result[bounded[index]].limit = stationary_moments(model, kept, index, far + 1, settled, limits);
}

}  // namespace

std::optional<double> StationarySignal::limit_variance() const {
  if (!limit) return std::nullopt;
  return *std::max_element(limit->variance.begin(), limit->variance.end());
}

std::vector<StationarySignal> stationary_signals(const StringTheory& theory, const std::vector<std::string>& names,
                                                 std::size_t followers, bool string_stable) {
  if (followers < 1) throw std::invalid_argument("followers: 0: must be >= 1");
  const auto input = std::find(names.begin(), names.end(), kInput);
  if (input != names.end() && !theory.has_cross_spectra()) {
    std::vector<std::string> others = names;
    others.erase(others.begin() + (input - names.begin()));
    std::vector<StationarySignal> result = stationary_signals(theory, others, followers, string_stable);
    const auto crossed = StringTheory::of(theory.model(), true);
    result.insert(result.begin() + (input - names.begin()),
                  stationary_signals(*crossed, {kInput}, followers, string_stable).front());
    return result;
  }
  const PlatoonModel& model = theory.model();
  const std::vector<double> none(followers, kNaN);
  std::vector<StationarySignal> result(names.size(), StationarySignal{{none, none, none}, std::nullopt});
  if (!theory.mean_square_stable() || names.empty()) return result;
  try {
    const SignalLists signals = signal_lists(model, names, followers);
    const std::vector<double> values =
        theory.settled(followers, [&signals](StringWalk& walk) { return moments_along(walk, signals); });
    const std::vector<double> errors = theory.means(followers);
    for (std::size_t s = 0; s < names.size(); ++s)
      result[s].followers = stationary_moments(model, signals, s, 1, errors, values);
    if (string_stable) add_limits(theory, names, result);
  } catch (const NarrowSpectra&) {
    // The moments that were not computed stay NaN, and the limit is absent.
  }
  return result;
}

}  // namespace platoon
