#include "stochastic_platoon/run/report/prediction.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "stochastic_platoon/math/links/chain_moments.hpp"
#include "stochastic_platoon/math/links/linked_pattern.hpp"
#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/numerics/special_values.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/math/string/collision_risk.hpp"
#include "stochastic_platoon/math/string/contradictions.hpp"
#include "stochastic_platoon/math/string/error_moments.hpp"
#include "stochastic_platoon/math/string/rounding_bound.hpp"
#include "stochastic_platoon/math/string/settling_time.hpp"
#include "stochastic_platoon/math/string/stationary_variance.hpp"
#include "stochastic_platoon/run/report/json_value.hpp"
#include "stochastic_platoon/run/report/plausibility.hpp"

namespace platoon {

namespace {

// The losses of a model that needs_chain_moments(), which have no fourth moments.
std::string no_fourth_moments(const PlatoonModel& model) {
  const char* const losses = has_bursts(model) ? "losses in bursts"
                             : hears_predecessors_only(model)
                                 ? "lost positions after a steady start"
                                 : "losses in a string that hears others than predecessors";
  return std::string(losses) +
         ": the theory has means and variances but not the scatter of measured variances, so that the means alone are judged";
}

// The cells in which losses carry on what is left of the start, or of a change of speed, in more than a share of the
// variance: that is a product of random factors, which few realizations carry, so that its fourth moment is unknown.
std::size_t void_remainders(const PlatoonModel& model, const RunOptions& run, const std::vector<double>& variance,
                            std::vector<double>& fourth_cumulant) {
  constexpr double kDecayed = 0.3, kShare = 0.02;
  PlatoonModel quiet = model;
  quiet.leader = LeaderProfile({}, model.sample_period);
  quiet.recorded_leader.clear();
  for (VehicleType& type : quiet.types) type.vehicle.initial_position = {};
  const std::vector<double> of_noise = error_moments(quiet, run.followers, run.steps).variance;
  std::size_t found = 0;
  for (std::size_t i = 1; i <= run.followers; ++i) {
    double largest = 0.0;
    for (std::int64_t k = 0; k < run.steps; ++k) {
      const std::size_t c = cell(i, k, run.steps);
      const double left = variance[c] - of_noise[c];
      largest = std::max(largest, left);
      if (!(left < kDecayed * largest && left > kShare * variance[c])) continue;
      fourth_cumulant[c] = kInfinity;
      ++found;
    }
  }
  return found;
}

// Widens bounds of rounding to a nanometre, or to 1e-9 of a mean that grows: runs and chain_moments() round their means
// in different ways, and a cell without variance, or with one that has decayed to less than rounding, has no other
// tolerance.
void allow_rounding(Prediction& prediction) {
  prediction.rounding.resize(prediction.mean.size());
  for (std::size_t c = 0; c < prediction.mean.size(); ++c)
    prediction.rounding[c] = std::max(prediction.rounding[c], 1e-9 * std::max(1.0, std::abs(prediction.mean[c])));
}

// An average over time without noise has no standard error, but what the burn-in leaves of the start, and rounding.
void allow_rest_of_start(const PlatoonModel& model, Prediction& prediction) {
  double fastest = 0.0, start = 1.0;
  for (const SpeedChange& change : model.leader.changes()) fastest = std::max(fastest, std::abs(change.value));
  for (const VehicleType& type : model.types)
    start = std::max(start, (1.0 + type.vehicle.headway) * model.sample_period * fastest);
  for (const double variance : prediction.variance)
    prediction.rounding.push_back(variance == 0.0 ? kRestOfStart * start : 0.0);
}

Prediction no_prediction(const Configuration& configuration, const std::string& reason) {
  const RunOptions& run = configuration.run;
  const std::size_t cells =
      run.followers * static_cast<std::size_t>(run.averaging() == Averaging::over_time ? 1 : run.steps);
  StringStability unknown;
  unknown.spectral_radius = kNaN;
  unknown.reason = reason_without_theory(reason);
  return {unknown, std::vector<double>(run.followers, kNaN), std::vector<double>(cells, kNaN),
          std::vector<double>(cells, kNaN)};
}

// Averages that contain the transient of the start have no known standard error.
std::string burn_in_warning(const Configuration& configuration) {
  const PlatoonModel& model = configuration.model;
  const std::int64_t given = configuration.run.burn_in;
  const std::optional<std::int64_t> needed = settling_steps(model, configuration.run.followers);
  if (!needed || given >= *needed) return "";
  return formatted(
      "burn_in: %lld: %s are below the %s in which the start decays to 1e-6, so that the averages are not compared with the theory",
      static_cast<long long>(given), duration(given, model).c_str(), duration_in_steps(*needed, model).c_str());
}

// Sets the values of all followers from the first external vehicle on to NaN.
void void_behind(const RunOptions& run, Prediction& prediction) {
  const std::size_t steps = run.averaging() == Averaging::over_time ? 1 : static_cast<std::size_t>(run.steps);
  const auto clear = [](std::vector<double>& values, std::size_t kept) {
    std::fill(values.begin() + static_cast<std::ptrdiff_t>(kept), values.end(), kNaN);
  };
  const std::size_t last = prediction.followers_with_theory;
  clear(prediction.stationary_variance, last);
  clear(prediction.mean, last * steps);
  clear(prediction.variance, last * steps);
  for (std::size_t i = last; i < prediction.error_correlation.size(); ++i) prediction.error_correlation[i] = {};
  prediction.stability.limit_variance.reset();
  prediction.stability.reason += "; this speaks of " +
                                 std::string(last > 1 ? "followers 1 to " + std::to_string(last) : "follower 1") +
                                 ", before vehicle_" + std::to_string(last + 1) + ", which is external";
}

// What judges the signals beside their moments.
void add_bounds_of_signals(const Configuration& configuration, Prediction& prediction) {
  const RunOptions& run = configuration.run;
  if (run.signals.empty()) return;
  for (const Signal& signal : signals_of(configuration.model, run.signals, 1).requested)
    prediction.signal_rounding.push_back(
        signal_rounding(configuration.model, signal, run.followers, static_cast<std::size_t>(run.steps)));
  const auto gap = std::find(run.signals.begin(), run.signals.end(), kGap) - run.signals.begin();
  if (static_cast<std::size_t>(gap) == run.signals.size() || !prediction.normal) return;
  prediction.collision_bound =
      collision_bounds(prediction.signals[static_cast<std::size_t>(gap)], static_cast<std::size_t>(run.steps));
}

}  // namespace

nlohmann::json to_json(const StringStability& stability) {
  return {{"spectral_radius", number(stability.spectral_radius)}, {"peak_gain", number(stability.peak_gain)},
          {"peak_frequency", number(stability.peak_frequency)},   {"mean_square_stable", stability.mean_square_stable},
          {"string_stable", truth(stability.decision())},         {"loss_gain", number(stability.loss_gain)},
          {"limit_variance", number(stability.limit_variance)},   {"reason", stability.reason}};
}

std::string contradiction_line(const std::string& contradiction) {
  return "ERROR: figures of the theory contradict each other: " + contradiction + "; do not use either\n";
}

namespace {

// `motion` receives the figures that plausibility_warnings() takes.
Prediction theory_of(const Configuration& configuration, std::vector<SignalFigures>& motion) {
  const RunOptions& run = configuration.run;
  if (const auto reason = no_theory(configuration.model)) return no_prediction(configuration, *reason);
  const bool plain = hears_predecessors_only(configuration.model), of_chain = needs_chain_moments(configuration.model);
  const std::int64_t most = of_chain ? most_chain_steps(configuration.model, run.followers) : run.steps;
  if (run.steps > most) {
    return no_prediction(
        configuration,
        formatted("the exact moments of %s take the square of the %lld steps, and at most %lld for these vehicles",
                  has_bursts(configuration.model) ? "losses in bursts" : "such losses",
                  static_cast<long long>(run.steps), static_cast<long long>(most)));
  }
  if (run.followers_before_external() == 0)
    return no_prediction(configuration, "vehicle_1, which the others follow, is external");
  const auto theory = StringTheory::of(configuration.model);
  Prediction prediction{string_stability(*theory), stationary_variances(*theory, run.followers), {}, {}};
  prediction.normal = has_normal_errors(configuration.model);
  if (run.averaging() == Averaging::over_time) {
    prediction.mean =
        is_papers(configuration.model) ? std::vector<double>(run.followers, 0.0) : theory->means(run.followers);
    prediction.variance = prediction.stationary_variance;
    allow_rest_of_start(configuration.model, prediction);
    prediction.warning = burn_in_warning(configuration);
    if (prediction.warning.empty() && !has_bursts(configuration.model) && plain)
      prediction.error_correlation = error_correlations(configuration.model, run.followers);
  } else {
    const std::vector<std::string> names = with_motion(run.signals, run);
    StringMoments moments =
        string_moments(configuration.model, names, run.followers, run.steps, &prediction.fourth_cumulant);
    motion = signal_figures(names, moments.signals, run.followers_before_external(), run.steps);
    moments.signals.resize(run.signals.size());
    if (of_chain) prediction.warning = no_fourth_moments(configuration.model);
    prediction.means_only = of_chain;
    if (!prediction.fourth_cumulant.empty())
      prediction.remainders =
          void_remainders(configuration.model, run, moments.errors.variance, prediction.fourth_cumulant);
    if (plain) prediction.rounding = rounding_bounds(configuration.model, moments.errors);
    prediction.mean.swap(moments.errors.mean);
    prediction.variance.swap(moments.errors.variance);
    prediction.signals.swap(moments.signals);
    if (of_chain || !plain) allow_rounding(prediction);
    add_bounds_of_signals(configuration, prediction);
  }
  const std::vector<double> none;
  prediction.contradictions = contradictions(
      configuration.model,
      {{prediction.stationary_variance, run.averaging() == Averaging::over_time ? none : prediction.variance,
        prediction.stability.limit_variance}},
      run.steps);
  prediction.followers_with_theory = run.followers_before_external();
  if (!run.external.empty()) void_behind(run, prediction);
  return prediction;
}

}  // namespace

Prediction predict(const Configuration& configuration) {
  std::vector<SignalFigures> motion;
  Configuration within_run = configuration;
  within_run.model = model_within_run(configuration);
  Prediction prediction = theory_of(within_run, motion);
  prediction.warnings = plausibility_warnings(configuration, motion);
  if (prediction.remainders > 0)
    prediction.warnings.push_back(formatted(
        "losses carry on what is left of the start or of a change of speed, in few realizations: %zu of %zu variances are not judged",
        prediction.remainders, prediction.variance.size()));
  return prediction;
}

}  // namespace platoon
