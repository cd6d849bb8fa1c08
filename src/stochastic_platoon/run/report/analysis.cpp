#include "stochastic_platoon/run/report/analysis.hpp"

#include <algorithm>
#include <boost/math/constants/constants.hpp>
#include <cmath>
#include <initializer_list>

#include "stochastic_platoon/math/links/chain_moments.hpp"
#include "stochastic_platoon/math/links/linked_pattern.hpp"
#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/model/loop_assumptions.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/math/string/contradictions.hpp"
#include "stochastic_platoon/math/string/critical_delay.hpp"
#include "stochastic_platoon/math/string/rounding_bound.hpp"
#include "stochastic_platoon/math/string/settled_hearing.hpp"
#include "stochastic_platoon/math/string/stationary_variance.hpp"
#include "stochastic_platoon/run/report/age_analysis.hpp"
#include "stochastic_platoon/run/report/json_value.hpp"
#include "stochastic_platoon/run/report/linear_theory.hpp"
#include "stochastic_platoon/run/report/plausibility.hpp"

namespace platoon {

namespace {

nlohmann::json coefficients(const Polynomial& polynomial) {
  return numbers({polynomial.data(), polynomial.data() + polynomial.size()});
}

// Throws ConfigurationError unless the theory of this run can be computed. `most_steps`: of these `losses`.
void check_run(RunOptions run, const SignalRequest& signals, std::optional<std::int64_t> most_steps,
               const char* losses) {
  if (run.averaging() == Averaging::over_time) throw ConfigurationError({"steps: 0: must be at least 1 here"});
  run.signals = signals.names;
  if (run.burn_in > 0 && !run.has_amplification()) {
    throw ConfigurationError({formatted("burn-in: %lld: must go with --signals speed, and be at most steps - 2 = %lld",
                                        static_cast<long long>(run.burn_in), static_cast<long long>(run.steps - 2))});
  }
  if (most_steps && run.steps > *most_steps) {
    throw ConfigurationError(
        {formatted("steps: %lld: must be at most %lld with %s and %zu followers", static_cast<long long>(run.steps),
                   static_cast<long long>(*most_steps), losses, run.followers)});
  }
}

/// To pi on a logarithmic scale, with the frequency of the peak if there is one [rad/sample].
std::vector<double> frequencies_about(double peak) {
  constexpr int kCount = 400;
  constexpr double kLowest = 1e-4;
  const double pi = boost::math::double_constants::pi;
  std::vector<double> frequencies;
  for (int j = 0; j < kCount; ++j) frequencies.push_back(pi * std::pow(kLowest / pi, 1.0 - j / (kCount - 1.0)));
  if (peak > kLowest) frequencies.insert(std::upper_bound(frequencies.begin(), frequencies.end(), peak), peak);
  return frequencies;
}

// The keys of `linear` among those given as linear/KEY.
std::set<std::string> linear_keys(const std::set<std::string>& keys) {
  const std::string prefix = "linear/";
  std::set<std::string> found;
  for (const std::string& key : keys) {
    if (key.compare(0, prefix.size(), prefix) == 0) found.insert(key.substr(prefix.size()));
  }
  return found;
}

}  // namespace

Analysis analyze(const Configuration& given, const SignalRequest& signals, const StageObserver& begins,
                 const std::set<std::string>& keys) {
  Configuration configuration = given;
  configuration.model = model_within_run(given);
  const PlatoonModel& model = configuration.model;
  const std::size_t followers = configuration.run.followers;
  const std::int64_t steps = configuration.run.steps;
  Analysis analysis{};
  analysis.without_theory = no_theory(model);
  std::optional<std::int64_t> most_steps;
  const bool plain = hears_predecessors_only(model);
  if (!analysis.without_theory && needs_chain_moments(model)) most_steps = most_chain_steps(model, followers);
  check_run(configuration.run, signals, most_steps, has_bursts(model) ? "losses in bursts" : "such losses");
  analysis.signals.request = signals;
  const VehicleModel& own = model.default_vehicle();
  if (plain) analysis.integral_defect = integral_defect(own.loop, own.headway);
  const auto needs_any = [&keys](std::initializer_list<const char*> computed) {
    return keys.empty() ||
           std::any_of(computed.begin(), computed.end(), [&keys](const char* key) { return keys.count(key) > 0; });
  };
  // The same; announces the stage that computes them.
  const auto needs = [&](const char* stage, std::initializer_list<const char*> computed) {
    const bool needed = needs_any(computed);
    if (needed) begins(stage);
    return needed;
  };
  if (needs_any({"warnings"}) && analysis.without_theory) analysis.warnings = plausibility_warnings(given);
  if (plain && needs("rounding", {"rounding"}))
    analysis.rounding = rounding_bound_of_a_metre(own.loop.realization, static_cast<std::size_t>(steps));
  const std::set<std::string> of_linear = linear_keys(keys);
  if (has_limits(model) && (!of_linear.empty() || needs_any({"linear"}))) {
    begins("the same cars without limits");
    const bool all = needs_any({"linear"});
    analysis.linear = std::make_shared<const Analysis>(
        analyze(linear_configuration(configuration), signals, begins, all ? std::set<std::string>() : of_linear));
    if (all || of_linear.count("probability_beyond_input_limits") > 0)
      analysis.beyond_limits = beyond_limits(configuration);
  }
  if (analysis.without_theory) return analysis;
  std::unique_ptr<const StringTheory> known;
  const auto theory = [&]() -> const StringTheory& {
    if (known == nullptr) known = StringTheory::of(model);
    return *known;
  };
  const bool with_limit =
      needs_any({"loss_gain", "limit_variance", "reason", "contradictions", "signals", "collision", "amplification"});
  if (needs("verdict", {"spectral_radius", "peak_gain", "peak_frequency", "mean_square_stable", "string_stable",
                        "loss_gain", "limit_variance", "reason", "contradictions", "bounds", "norms", "signals",
                        "collision", "amplification", "gain_along_string"}))
    analysis.stability = string_stability(theory(), with_limit);
  if (needs("margin of the string", {"string_margin"})) analysis.string_margin = string_margin(theory());
  if (needs("gain along the string", {"gain_along_string"})) {
    analysis.frequencies = frequencies_about(analysis.stability.peak_frequency);
    analysis.gains = theory().gains(analysis.frequencies);
  }
  if (needs("margins", {"phase_margin", "delay_margin", "sensitivity_peak"}))
    analysis.robustness.margins = loop_margins(model);
  if (needs("critical delay", {"critical_delay"})) analysis.robustness.critical_delay = critical_delay(model);
  if (needs("stationary variances", {"stationary_variance", "contradictions"}))
    analysis.stationary_variance = stationary_variances(theory(), followers);
  const std::vector<double>& variances = analysis.stationary_variance;
  const StringStability& verdict = analysis.stability;
  if ((verdict.mean_square_stable && !variances.empty() && std::isnan(variances.front())) ||
      (verdict.string_stable && with_limit && !verdict.limit_variance))
    analysis.not_computed = std::string("not computed: ") + NarrowSpectra().what();
  if ((has_radios(model) || !plain) && needs("shares by input", {"stationary_variance_by_input"}))
    analysis.stationary_variance_by_input = stationary_variances_by_input(theory(), followers);
  std::vector<SignalFigures> motion;
  const bool needs_signals = needs_any({"signals", "collision", "amplification"});
  const std::vector<std::string> names = needs_signals ? signals.all_names() : std::vector<std::string>();
  if (needs("mean and variance of every step", {"mean", "variance", "norms", "contradictions"})) {
    const std::vector<std::string> computed = needs_any({"warnings"}) ? with_motion(names, configuration.run) : names;
    StringMoments moments = string_moments(model, computed, followers, steps);
    motion = signal_figures(computed, moments.signals, followers, steps);
    moments.signals.resize(names.size());
    analysis.moments = std::move(moments.errors);
    analysis.signals.moments = std::move(moments.signals);
    analysis.norms = error_norms(analysis.moments, NormOrder::kTwo, NormOrder::kInfinity);
  }
  if (needs_any({"warnings"})) analysis.warnings = plausibility_warnings(given, motion);
  if (is_papers(model) && needs("bounds", {"bounds", "norms"}) && analysis.stability.mean_square_stable)
    analysis.bounds = theorem_two_bounds(model, followers, steps);
  if (!is_papers(model) && needs("stationary means", {"stationary_mean"}))
    analysis.stationary_mean = theory().means(followers);
  if (needs("stable headways",
            {"critical_headway", "critical_headway_seconds", "critical_headway_types", "stable_headways"}))
    analysis.headways = stable_headways(model);
  if (needs("stable loss probabilities",
            {"critical_loss_probability", "critical_loss_types", "stable_loss_probabilities"}))
    analysis.losses = stable_losses(model);
  if (needs("critical mean burst", {"critical_mean_burst"})) analysis.bursts = critical_mean_burst(model);
  if (!plain && needs("stable weights of the leader", {"critical_leader_share", "stable_leader_shares"}))
    analysis.leader_shares = stable_leader_shares(model);
  if (needs_signals)
    analysis.signals =
        analyze_signals(configuration, theory(), std::move(analysis.signals), analysis.stability.string_stable, begins);
  if (needs("contradictions", {"contradictions"})) {
    std::vector<TheoryFigures> figures{
        {analysis.stationary_variance, analysis.moments.variance, analysis.stability.limit_variance}};
    const std::vector<StationarySignal>& stationary = analysis.signals.stationary;
    for (std::size_t s = 0; s < stationary.size(); ++s)
      figures.push_back({stationary[s].followers.variance, analysis.signals.moments[s].variance,
                         stationary[s].limit_variance(), names[s]});
    analysis.contradictions = contradictions(model, figures, steps);
  }
  return analysis;
}

namespace {

nlohmann::json pairs(const std::vector<StableInterval>& intervals) {
  nlohmann::json list = nlohmann::json::array();
  for (const StableInterval& interval : intervals) list.push_back({interval.from, interval.to});
  return list;
}

nlohmann::json theory_to_json(const Configuration& configuration, const Analysis& analysis) {
  const PlatoonModel& model = configuration.model;
  const VehicleModel& own = model.default_vehicle();
  const auto steps = static_cast<std::size_t>(configuration.run.steps);
  nlohmann::json headways, losses, leader_shares, by_input, bounds;
  if (analysis.headways) headways = pairs(analysis.headways->intervals);
  if (analysis.losses) losses = pairs(analysis.losses->intervals);
  if (analysis.leader_shares) leader_shares = pairs(analysis.leader_shares->intervals);
  const std::optional<double> critical = analysis.headways ? analysis.headways->critical : std::nullopt;
  nlohmann::json norms = {{"mean_l2", numbers(analysis.norms.mean)},
                          {"variance_linf", numbers(analysis.norms.variance)},
                          {"mean_bound", number(analysis.bounds ? analysis.bounds->mean_bound : std::nullopt)},
                          {"variance_bound", number(analysis.bounds ? analysis.bounds->variance_bound : std::nullopt)}};
  for (const std::vector<double>& shares : analysis.stationary_variance_by_input) {
    for (std::size_t input = 0; input < shares.size(); ++input) by_input[input].push_back(number(shares[input]));
  }
  if (analysis.bounds) {
    bounds = {{"alpha_1", number(analysis.bounds->alpha_1)},
              {"beta_1", number(analysis.bounds->beta_1)},
              {"alpha_2", number(analysis.bounds->alpha_2)},
              {"beta_2", number(analysis.bounds->beta_2)},
              {"stated_beta_2", number(analysis.bounds->stated_beta_2)}};
  }
  nlohmann::json document = to_json(analysis.robustness, model.sample_period);
  if (!analysis.stability.reason.empty()) document.update(to_json(analysis.stability));
  document.update(
      {{"sample_period", model.sample_period},
       {"transfer",
        {{"numerator", coefficients(own.loop.transfer.numerator())},
         {"denominator", coefficients(own.loop.transfer.denominator())}}},
       {"integral_defect", number(analysis.integral_defect)},
       {"string_margin", number(analysis.string_margin)},
       {"critical_headway", number(critical)},
       {"critical_headway_seconds", critical ? nlohmann::json(*critical * model.sample_period) : nlohmann::json()},
       {"stable_headways", headways},
       {"critical_headway_types", analysis.headways ? nlohmann::json(analysis.headways->types) : nlohmann::json()},
       {"critical_mean_burst", number(analysis.bursts ? analysis.bursts->critical : std::nullopt)},
       {"critical_loss_probability", number(analysis.losses ? analysis.losses->critical : std::nullopt)},
       {"critical_loss_types", analysis.losses ? nlohmann::json(analysis.losses->types) : nlohmann::json()},
       {"stable_loss_probabilities", losses},
       {"critical_leader_share", number(analysis.leader_shares ? analysis.leader_shares->critical : std::nullopt)},
       {"stable_leader_shares", leader_shares},
       {"gain_along_string", {{"frequency", analysis.frequencies}, {"gain", numbers(analysis.gains)}}},
       {"stationary_mean", numbers(analysis.stationary_mean)},
       {"stationary_variance", numbers(analysis.stationary_variance)},
       {"stationary_variance_by_input", by_input},
       {"contradictions", analysis.contradictions},
       {"norms", norms},
       {"bounds", bounds}});
  // A list would copy these, which may be large.
  document["mean"] = rows(analysis.moments.mean, steps);
  document["variance"] = rows(analysis.moments.variance, steps);
  return document;
}

}  // namespace

nlohmann::json to_json(const Configuration& configuration, const Analysis& analysis) {
  const VehicleModel& own = configuration.model.default_vehicle();
  nlohmann::json document = nlohmann::json::object();
  if (analysis.without_theory)
    document["reason"] = reason_without_theory(*analysis.without_theory);
  else
    document = theory_to_json(configuration, analysis);
  std::vector<std::string> warnings = analysis.warnings;
  if (!analysis.not_computed.empty()) warnings.push_back("stationary variances: " + analysis.not_computed);
  document.update({{"headway", own.headway},
                   {"noise_variance", own.position().noise_variance},
                   {"theory", name_of_theory(!analysis.without_theory)},
                   {"rounding", number(analysis.rounding)},
                   {"warnings", warnings},
                   {"age_of_information", ages_to_json(configuration.model, configuration.run.followers)}});
  add_to_json(configuration, analysis.signals, document);
  if (!analysis.linear) return document;
  const std::vector<double>& beyond = analysis.beyond_limits;
  document["linear"] = to_json(linear_configuration(configuration), *analysis.linear);
  document["linear"]["probability_beyond_input_limits"] =
      beyond.empty() ? nlohmann::json() : rows(beyond, static_cast<std::size_t>(configuration.run.steps));
  return document;
}

}  // namespace platoon
