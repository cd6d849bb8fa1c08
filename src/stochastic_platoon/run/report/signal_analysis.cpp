#include "stochastic_platoon/run/report/signal_analysis.hpp"

#include <algorithm>
#include <cmath>

#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/math/string/stationary_variance.hpp"
#include "stochastic_platoon/run/configuration/configuration_error.hpp"
#include "stochastic_platoon/run/configuration/section.hpp"
#include "stochastic_platoon/run/report/figure.hpp"
#include "stochastic_platoon/run/report/json_value.hpp"

namespace platoon {

namespace {

std::string squared(const std::string& unit) {
  const auto slash = unit.find('/');
  if (slash == std::string::npos) return unit + "^2";
  return "(" + unit + ")^2";
}

/// "A of follower 1, B of follower N; of an endless string: C".
std::string along(const std::vector<double>& values, std::optional<double> limit, const std::string& unit) {
  std::string text = figure(values.front(), unit) + " of follower 1, ";
  if (values.size() > 1) text += figure(values.back(), unit) + formatted(" of follower %zu, ", values.size());
  return text + figure(limit, unit) + " of an endless string";
}

// [m/s], at which stationary figures hold.
double last_speed(const Configuration& configuration) {
  return metres_per_step(model_within_run(configuration)) / configuration.model.sample_period;
}

std::string collision_lines(const Configuration& configuration, const SignalAnalysis& analysis) {
  const CollisionRisk& risk = *analysis.collisions;
  const double probability = *analysis.request.collision_probability;
  std::string text = "Collisions: probability of a gap below 0 " + along(risk.probability, risk.limit_probability, "") +
                     "; new ones per step " + along(risk.rate, risk.limit_rate, "") + "\n";
  const auto worst = std::max_element(risk.bound.begin(), risk.bound.end());
  text += formatted("Probability of a collision in %s: at most %.6g, of follower %zu\n",
                    duration(configuration.run.steps, configuration.model).c_str(), *worst,
                    static_cast<std::size_t>(worst - risk.bound.begin()) + 1);
  text += formatted("Required standstill distance for %g per step: ", probability) +
          along(risk.required_distance, risk.limit_required_distance, "m") +
          formatted("; for any of the %zu followers ", risk.required_distance.size()) +
          figure(risk.platoon_required_distance, "m") +
          formatted(", at the leader's last speed, %.6g m/s\n", last_speed(configuration));
  return text;
}

nlohmann::json to_json(const Configuration& configuration, const CollisionRisk& risk) {
  return {{"speed", last_speed(configuration)},
          {"required_standstill_distance_of_platoon", number(risk.platoon_required_distance)},
          {"probability", numbers(risk.probability)},
          {"rate", numbers(risk.rate)},
          {"bound", numbers(risk.bound)},
          {"limit_probability", number(risk.limit_probability)},
          {"limit_rate", number(risk.limit_rate)},
          {"required_standstill_distance", number(risk.limit_required_distance)},
          {"required_standstill_distances", numbers(risk.required_distance)}};
}

// Lists over vehicles 0 .. N, with the column names of amplification.csv as keys.
nlohmann::json to_json(const std::vector<Amplification>& of, std::int64_t from) {
  nlohmann::json document = {{"from_step", from}};
  for (const AmplificationFigure& figure : amplification_figures()) {
    std::vector<double> values;
    values.reserve(of.size());
    for (const Amplification& one : of) values.push_back(one.*figure.value);
    document[figure.name] = numbers(values);
  }
  return document;
}

}  // namespace

SignalRequest signal_request(const std::string& names, const std::string& collision_probability) {
  SignalRequest request;
  std::vector<std::string> problems;
  try {
    request.names = signal_names(names);
  } catch (const std::invalid_argument& error) {
    problems.emplace_back(error.what());
  }
  if (!collision_probability.empty()) {
    YAML::Node node;
    node["collision_probability"] = collision_probability;
    const Allowed allowed{"a number above 0 and below 0.5", kAboveZero, kLargest, 0.5};
    request.collision_probability = Section(node, "", problems).number("collision_probability", allowed);
  }
  if (!problems.empty()) throw ConfigurationError(problems);
  return request;
}

std::vector<std::string> SignalRequest::all_names() const {
  std::vector<std::string> all = names;
  if (collision_probability && std::find(all.begin(), all.end(), kGap) == all.end()) all.insert(all.begin(), kGap);
  return all;
}

SignalAnalysis analyze_signals(const Configuration& configuration, const StringTheory& theory, SignalAnalysis analysis,
                               bool string_stable, const StageObserver& begins) {
  const PlatoonModel& model = configuration.model;
  const RunOptions& run = configuration.run;
  const SignalRequest& request = analysis.request;
  const std::vector<std::string> names = request.all_names();
  if (names.empty()) return analysis;
  begins("stationary signals");
  analysis.stationary = stationary_signals(theory, names, run.followers, string_stable);
  if (analysis.moments.empty()) {
    begins("signals of every step");
    analysis.moments = signal_moments(model, names, run.followers, run.steps);
  }
  const SignalsByName signals = exact_signals(model, names, analysis.moments, run.steps);
  if (signals.count("speed") > 0 && run.burn_in + 2 <= run.steps)
    analysis.amplification = amplification(signals, run.steps, run.burn_in);
  if (!request.collision_probability || !has_normal_errors(model)) return analysis;
  begins("collisions");
  const auto gap = static_cast<std::size_t>(std::find(names.begin(), names.end(), kGap) - names.begin());
  analysis.collisions = collision_risk(model, analysis.stationary[gap], analysis.moments[gap],
                                       static_cast<std::size_t>(run.steps), *request.collision_probability);
  return analysis;
}

std::string largest_and_tail(const std::vector<Amplification>& of) {
  std::size_t largest = 0;
  for (std::size_t i = 1; i < of.size(); ++i) {
    if (!std::isnan(of[i].l2_ratio) && (largest == 0 || of[i].l2_ratio > of[largest].l2_ratio)) largest = i;
  }
  if (largest == 0) return "";
  return formatted("largest %.6g of follower %zu, head to tail ", of[largest].l2_ratio, largest) +
         figure(of.back().l2_head_to_tail, "");
}

std::string amplification_line(const std::vector<Amplification>& of, std::int64_t from, const std::string& hidden) {
  if (of.front().rms_mean_speed == 0.0) {
    return formatted("Amplification: none, as the leader drives at constant speed from step %lld on",
                     static_cast<long long>(from));
  }
  const std::string found = largest_and_tail(of);
  return "Amplification of the speed (L2): " + (found.empty() ? "none, as " + hidden : found);
}

SignalsByName exact_signals(const PlatoonModel& model, const std::vector<std::string>& names,
                            const std::vector<SignalMoments>& moments, std::int64_t steps) {
  SignalsByName signals;
  for (std::size_t s = 0; s < moments.size(); ++s) {
    if (names[s] != kGap) signals[names[s]] = with_leader(model, names[s], moments[s], steps);
  }
  return signals;
}

std::string report(const Configuration& configuration, const SignalAnalysis& analysis) {
  const std::vector<std::string> names = analysis.request.all_names();
  if (names.empty()) return "";
  if (analysis.is_empty()) return "Signals and collisions: measured only\n";
  std::string text;
  for (std::size_t s = 0; s < names.size(); ++s) {
    std::string name = in_words(names[s]);
    name[0] = static_cast<char>(name[0] - 'a' + 'A');
    const StationarySignal& signal = analysis.stationary[s];
    text += name + ": stationary variance " +
            along(signal.followers.variance, signal.limit_variance(), squared(unit_of(names[s]))) + "\n";
  }
  if (!analysis.amplification.empty())
    text += amplification_line(analysis.amplification, configuration.run.burn_in, "no follower moves") + "\n";
  if (analysis.collisions) return text + collision_lines(configuration, analysis);
  return text + (analysis.request.collision_probability ? "Collisions: measured only, as gaps are not normal\n" : "");
}

void add_to_json(const Configuration& configuration, const SignalAnalysis& analysis, nlohmann::json& document) {
  const auto steps = static_cast<std::size_t>(configuration.run.steps);
  const std::vector<std::string> names = analysis.request.all_names();
  if (!names.empty()) document["signals"] = nullptr;
  if (analysis.request.collision_probability) document["collision"] = nullptr;
  if (std::find(names.begin(), names.end(), "speed") != names.end()) document["amplification"] = nullptr;
  if (!analysis.amplification.empty())
    document["amplification"] = to_json(analysis.amplification, configuration.run.burn_in);
  for (std::size_t s = 0; s < analysis.moments.size(); ++s) {
    const StationarySignal& signal = analysis.stationary[s];
    nlohmann::json& of = document["signals"][names[s]];
    of = {{"stationary_mean", numbers(signal.followers.mean)},
          {"stationary_variance", numbers(signal.followers.variance)},
          {"limit_variance", number(signal.limit_variance())}};
    // A list would copy these, which may be large.
    of["mean"] = rows(analysis.moments[s].mean, steps);
    of["variance"] = rows(analysis.moments[s].variance, steps);
  }
  if (analysis.collisions) document["collision"] = to_json(configuration, *analysis.collisions);
}

}  // namespace platoon
