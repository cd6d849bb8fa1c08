#include "stochastic_platoon/math/string/stationary_signals.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "stochastic_platoon/math/links/linked_string.hpp"
#include "stochastic_platoon/math/links/settled_spectra.hpp"
#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/numerics/special_values.hpp"
#include "stochastic_platoon/math/string/hearing_signals.hpp"
#include "stochastic_platoon/math/string/stationary_variance.hpp"

namespace platoon {

namespace {

using Signals = std::vector<Signal>;  // of one follower

std::vector<Signals> requested_signals(const PlatoonModel& model, const std::vector<std::string>& names,
                                       std::size_t followers) {
  std::vector<Signals> signals;
  for (std::size_t i = 1; i <= followers; ++i) signals.push_back(signals_of(model, names, i).requested);
  return signals;
}

/// The spectrum of a signal of a follower behind a predecessor with this spectrum that adds `added`.
Eigen::ArrayXd spectrum_of(const Signal& signal, const StringSpectra& spectra, std::size_t follower,
                           const Eigen::ArrayXd& before, const Eigen::ArrayXd& added) {
  if (signal.relative) return spectra[follower].of_gap * before + added;
  Eigen::ArrayXd spectrum = spectra[follower].gain * before + added;
  for (int n = 0; n < signal.order; ++n) spectrum *= 2.0 * spectra.from_one();
  return signal.factor * signal.factor * spectrum;
}

void append_moments(const Signals& signals, const StringSpectra& spectra, std::size_t follower,
                    const Eigen::ArrayXd& before, const Eigen::ArrayXd& added, std::vector<double>& values) {
  for (const Signal& signal : signals) {
    const Eigen::ArrayXd spectrum = spectrum_of(signal, spectra, follower, before, added);
    for (const double value : {spectra.mean(spectrum), 2.0 * spectra.mean(spectra.from_one() * spectrum)})
      values.push_back(std::isnan(value) ? kInfinity : value);
  }
}

/// Variance and change of every signal of one follower after the other.
std::vector<double> moments_by(const StringSpectra& spectra, const std::vector<Signals>& signals) {
  std::vector<double> values;
  pass_along(spectra, 0.0, signals.size(), [&](std::size_t i, const Eigen::ArrayXd& spectrum, const auto&) {
    append_moments(signals[i], spectra, i, spectrum, spectra[i].added_by_noise(), values);
    return true;
  });
  return values;
}

/// The same at each place of the pattern of an endless string.
std::vector<double> limit_moments_by(const StringSpectra& spectra, const std::vector<Signals>& signals) {
  std::vector<Eigen::ArrayXd> added;
  for (std::size_t j = 0; j < spectra.size(); ++j) added.push_back(spectra[j].added_by_noise());
  std::vector<double> values;
  Eigen::ArrayXd spectrum = spectra.in_front(added, spectra.pattern_margin());
  for (std::size_t j = 0; j < spectra.size(); ++j) {
    append_moments(signals[j], spectra, j, spectrum, added[j], values);
    spectrum = spectra[j].gain * spectrum + added[j];
  }
  return values;
}

}  // namespace

StationaryMoments stationary_moments(const PlatoonModel& model, const std::vector<std::vector<Signal>>& signals,
                                     std::size_t index, std::size_t first, const std::vector<double>& errors,
                                     const std::vector<double>& values) {
  const double speed = metres_per_step(model);
  StationaryMoments moments;
  for (std::size_t i = 0; i < signals.size(); ++i) {
    const Signal& signal = signals[i][index];
    const VehicleModel& own = vehicle(model, first + i);
    double mean = signal.order == 1 ? signal.factor * speed : 0.0;
    if (signal.relative) mean += own.standstill_distance + own.headway * speed + errors[i] - signal.offset;
    moments.mean.push_back(mean);
    const std::size_t at = 2 * (i * signals[i].size() + index);
    moments.variance.push_back(values[at]);
    moments.change.push_back(values[at + 1]);
  }
  return moments;
}

std::optional<double> StationarySignal::limit_variance() const {
  if (!limit) return std::nullopt;
  return *std::max_element(limit->variance.begin(), limit->variance.end());
}

std::vector<StationarySignal> stationary_signals(const PlatoonModel& model, const std::vector<std::string>& names,
                                                 std::size_t followers, bool string_stable) {
  if (followers < 1) throw std::invalid_argument("followers: 0: must be >= 1");
  if (!has_normal_errors(model))
    throw std::invalid_argument("model: has losses or quantisation: must have normal errors for stationary_signals()");
  if (!hears_predecessors_only(model)) return hearing_signals(model, names, followers, string_stable);
  if (const auto input = std::find(names.begin(), names.end(), kInput); input != names.end()) {
    std::vector<std::string> others = names;
    others.erase(others.begin() + (input - names.begin()));
    std::vector<StationarySignal> result = stationary_signals(model, others, followers, string_stable);
    result.insert(result.begin() + (input - names.begin()),
                  hearing_signals(model, {kInput}, followers, string_stable).front());
    return result;
  }
  const LinkedPattern pattern(model);
  const std::vector<Signals> signals = requested_signals(model, names, followers);
  std::vector<StationarySignal> result(names.size());
  if (!pattern.mean_square_stable()) {
    const std::vector<double> none(followers, kNaN);
    for (StationarySignal& signal : result) signal.followers = {none, none, none};
    return result;
  }
  const std::vector<double> values =
      settled_values(pattern, followers, [&](const StringSpectra& spectra) { return moments_by(spectra, signals); });
  const std::vector<double> errors = stationary_means(model, followers);
  for (std::size_t s = 0; s < names.size(); ++s)
    result[s].followers = stationary_moments(model, signals, s, 1, errors, values);
  if (!string_stable) return result;
  // Limits that do not exist are left out: their poles at w = 0 would keep the quadrature from settling.
  const int zeros = pattern.gain().zeros() - pattern.zeros_at_zero().noise;
  const std::size_t m = pattern.size();
  std::vector<Signals> endless = requested_signals(model, names, 2 * m);
  endless.erase(endless.begin(), endless.begin() + static_cast<std::ptrdiff_t>(m));  // behind no leader
  std::vector<std::size_t> bounded;
  for (std::size_t s = 0; s < names.size(); ++s) {
    if (zeros <= std::max(endless[0][s].order, 1)) bounded.push_back(s);
  }
  if (bounded.empty()) return result;
  std::vector<Signals> kept(m);
  for (std::size_t j = 0; j < m; ++j) {
    for (const std::size_t s : bounded) kept[j].push_back(endless[j][s]);
  }
  const std::vector<double> limits = settled_values(
      pattern, std::nullopt, [&](const StringSpectra& spectra) { return limit_moments_by(spectra, kept); });
  std::vector<double> far = stationary_means(model, 2 * m);
  far.erase(far.begin(), far.begin() + static_cast<std::ptrdiff_t>(m));
  for (std::size_t index = 0; index < bounded.size(); ++index)
    result[bounded[index]].limit = stationary_moments(model, kept, index, m + 1, far, limits);
  return result;
}

}  // namespace platoon
