#include "stochastic_platoon/run/report/analysis.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "stochastic_platoon/math/links/chain_moments.hpp"
#include "stochastic_platoon/math/links/linked_pattern.hpp"
#include "stochastic_platoon/math/model/loop_assumptions.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/math/string/contradictions.hpp"
#include "stochastic_platoon/math/string/critical_delay.hpp"
#include "stochastic_platoon/math/string/rounding_bound.hpp"
#include "stochastic_platoon/math/string/stationary_variance.hpp"
#include "stochastic_platoon/run/report/age_analysis.hpp"
#include "stochastic_platoon/run/report/figure.hpp"
#include "stochastic_platoon/run/report/json_value.hpp"
#include "stochastic_platoon/run/report/linear_theory.hpp"
#include "stochastic_platoon/run/report/plausibility.hpp"

namespace platoon {

namespace {

nlohmann::json coefficients(const Polynomial& polynomial) {
  return numbers({polynomial.data(), polynomial.data() + polynomial.size()});
}

std::string shown(const std::vector<HeadwayInterval>& intervals) {
  std::string text;
  for (const HeadwayInterval& interval : intervals) text += formatted(" [%.6g, %.6g]", interval.from, interval.to);
  return text.empty() ? " none" : text;
}

/// " of default, truck": the given types, if the string has several; else empty.
std::string of_types(const PlatoonModel& model, const std::vector<std::string>& types) {
  if (is_homogeneous(model)) return "";
  std::string text;
  for (const std::string& type : types) text += (text.empty() ? " of " : ", ") + type;
  return text;
}

std::string headway_line(const PlatoonModel& model, const Analysis& analysis) {
  if (!analysis.headways) {
    const bool followed = !types_with_default(model, &Inherited::headway).empty();
    return std::string("Critical headway: none, as ") +
           (followed ? "the closed loop itself was given and fits one headway\n"
                     : "no vehicle of the string follows the default headway\n");
  }
  const StableHeadways& headways = *analysis.headways;
  const std::string critical = headways.critical ? formatted("%.9g sample periods (%.9g s)", *headways.critical,
                                                             *headways.critical * model.sample_period)
                                                 : "none";
  return "Critical headway" + of_types(model, headways.types) + ": " + critical +
         formatted("; string stable headways within [%.6g, %.6g]:", headways.searched.from, headways.searched.to) +
         shown(headways.intervals) + "\n";
}

std::string loss_line(const PlatoonModel& model, const Analysis& analysis) {
  const std::optional<LossModel>& own_loss = varied_link(model.default_vehicle()).loss;
  if (own_loss && own_loss->markov) return "Critical loss probability: none, as a chain of states loses\n";
  if (!analysis.losses) return "Critical loss probability: none, as no vehicle of the string follows the default one\n";
  const std::optional<double> critical = analysis.losses->critical;
  const VehicleModel& own = model.default_vehicle();
  const std::string signal = own.feed_forward ? "input" : "position";
  return "Critical loss probability" + of_types(model, analysis.losses->types) + (own.feed_forward ? " by radio" : "") +
         (varied_link(own).loss ? ": " : " (a lost " + signal + " is replaced by the last one received): ") +
         (critical ? formatted("%.9g", *critical) : "none") +
         formatted("; string stable loss probabilities within [0, %.6g]%s:", analysis.losses->largest,
                   has_bursts(model) ? " at this mean burst" : "") +
         shown(analysis.losses->intervals) + "\n";
}

std::string burst_line(const PlatoonModel& model, const Analysis& analysis) {
  if (!analysis.bursts) return "";
  const CriticalBurst& bursts = *analysis.bursts;
  return "Critical mean burst" + of_types(model, bursts.types) + ": " +
         (bursts.critical ? formatted("%.9g steps", *bursts.critical)
          : bursts.stable
              ? formatted("none, as the string is stable for every one up to %.6g steps", bursts.to)
              : formatted("none, as the string is not stable at the shortest one, %.6g steps", bursts.from)) +
         "\n";
}

// Throws ConfigurationError unless the theory of this run can be computed. `most_steps`: of losses in bursts.
void check_run(RunOptions run, const SignalRequest& signals, std::optional<std::int64_t> most_steps) {
  if (run.averaging() == Averaging::over_time) throw ConfigurationError({"steps: 0: must be at least 1 here"});
  run.signals = signals.names;
  if (run.burn_in > 0 && !run.has_amplification()) {
    throw ConfigurationError({formatted("burn-in: %lld: must go with --signals speed, and be at most steps - 2 = %lld",
                                        static_cast<long long>(run.burn_in), static_cast<long long>(run.steps - 2))});
  }
  if (most_steps && run.steps > *most_steps) {
    throw ConfigurationError(
        {formatted("steps: %lld: must be at most %lld with losses in bursts and %zu followers",
                   static_cast<long long>(run.steps), static_cast<long long>(*most_steps), run.followers)});
  }
}

}  // namespace

Analysis analyze(const Configuration& configuration, const SignalRequest& signals, const StageObserver& begins,
                 const std::set<std::string>& keys) {
  const PlatoonModel& model = configuration.model;
  const std::size_t followers = configuration.run.followers;
  const std::int64_t steps = configuration.run.steps;
  Analysis analysis{};
  analysis.without_theory = no_theory(model);
  std::optional<std::int64_t> most_steps;
  if (!analysis.without_theory && has_bursts(model)) most_steps = most_chain_steps(model, followers);
  check_run(configuration.run, signals, most_steps);
  analysis.signals.request = signals;
  analysis.warnings = plausibility_warnings(configuration);
  const VehicleModel& own = model.default_vehicle();
  analysis.integral_defect = integral_defect(own.loop, own.headway);
  // Whether one of these keys is needed; announces the stage that computes them.
  const auto needs = [&](const char* stage, std::initializer_list<const char*> computed) {
    const bool needed = keys.empty() || std::any_of(computed.begin(), computed.end(),
                                                    [&keys](const char* key) { return keys.count(key) > 0; });
    if (needed) begins(stage);
    return needed;
  };
  if (needs("rounding", {"rounding"}))
    analysis.rounding = rounding_bound_of_a_metre(own.loop.realization, static_cast<std::size_t>(steps));
  if (has_limits(model) && needs("the same cars without limits", {"linear"})) {
    analysis.linear = std::make_shared<const Analysis>(analyze(linear_configuration(configuration), signals, begins));
    analysis.beyond_limits = beyond_limits(configuration);
  }
  if (analysis.without_theory) return analysis;
  if (needs("verdict",
            {"spectral_radius", "peak_gain", "peak_frequency", "mean_square_stable", "string_stable", "loss_gain",
             "limit_variance", "reason", "contradictions", "bounds", "norms", "signals", "collision", "amplification"}))
    analysis.stability = string_stability(model);
  if (needs("margins", {"phase_margin", "delay_margin", "sensitivity_peak"}))
    analysis.robustness.margins = loop_margins(model);
  if (needs("critical delay", {"critical_delay"})) analysis.robustness.critical_radio_delay = critical_delay(model);
  if (needs("stationary variances", {"stationary_variance", "contradictions"}))
    analysis.stationary_variance = stationary_variances(model, followers);
  if (has_feed_forward(model) && needs("shares by input", {"stationary_variance_by_input"}))
    analysis.stationary_variance_by_input = stationary_variances_by_input(model, followers);
  if (needs("mean and variance of every step", {"mean", "variance", "norms", "contradictions"})) {
    analysis.moments = error_moments(model, followers, steps);
    analysis.norms = error_norms(analysis.moments, NormOrder::kTwo, NormOrder::kInfinity);
  }
  if (needs("contradictions", {"contradictions"}))
    analysis.contradictions =
        contradictions(model, {analysis.stability, analysis.stationary_variance, analysis.moments.variance, steps});
  if (is_papers(model) && needs("bounds", {"bounds", "norms"}) && analysis.stability.mean_square_stable)
    analysis.bounds = theorem_two_bounds(model, followers, steps);
  if (!is_papers(model) && needs("stationary means", {"stationary_mean"}))
    analysis.stationary_mean = stationary_means(model, followers);
  if (needs("stable headways",
            {"critical_headway", "critical_headway_seconds", "critical_headway_types", "stable_headways"}))
    analysis.headways = stable_headways(model);
  if (needs("stable loss probabilities",
            {"critical_loss_probability", "critical_loss_types", "stable_loss_probabilities"}))
    analysis.losses = stable_losses(model);
  if (needs("critical mean burst", {"critical_mean_burst"})) analysis.bursts = critical_mean_burst(model);
  if (needs("signals", {"signals", "collision", "amplification"}))
    analysis.signals = analyze_signals(configuration, signals, analysis.stability.string_stable, begins);
  return analysis;
}

std::string report(const Configuration& configuration, const Analysis& analysis) {
  const PlatoonModel& model = configuration.model;
  const StringStability& stability = analysis.stability;
  const VehicleModel& own = model.default_vehicle();
  std::string text =
      formatted("h = %g (%g s), P_d = %g m^2", own.headway, own.headway * model.sample_period, own.noise_variance);
  if (own.feed_forward) text += formatted(", radio %g (m/s^2)^2", own.feed_forward->noise_variance);
  text += ": ";
  if (analysis.without_theory) {
    text += "no theory, as " + *analysis.without_theory + ": monte_carlo measures their effect\n" + age_report(model) +
            report(configuration, analysis.signals) + warning_lines(analysis.warnings);
    if (!analysis.linear) return text;
    text += "The same cars without limits (linear): " + report(linear_configuration(configuration), *analysis.linear) +
            beyond_limits_report(configuration, analysis.beyond_limits);
    return text;
  }
  text += stability.reason + "\n";
  text += "rho(A) = " + beside_one(stability.spectral_radius) + ": the errors' mean and variance " +
          (stability.mean_square_stable ? "settle" : "DO NOT SETTLE") + " over time\n";
  text += std::isnan(stability.peak_gain)
              ? "peak of |T|: none, as the errors do not settle\n"
              : formatted("peak of |%s| = %.9g at w = %.6g rad/sample\n", has_feed_forward(model) ? "Gamma" : "T",
                          stability.peak_gain, stability.peak_frequency);
  text += report(model, analysis.robustness);
  text += headway_line(model, analysis) + loss_line(model, analysis) + burst_line(model, analysis) + age_report(model);
  const std::vector<double>& stationary = analysis.stationary_variance;
  text += "Stationary variance: " + figure(stationary.front(), "m^2") + " of follower 1, " +
          figure(stationary.back(), "m^2") + formatted(" of follower %zu; of an endless string: ", stationary.size()) +
          figure(stability.limit_variance, "m^2") + "\n";
  if (!analysis.stationary_variance_by_input.empty()) {
    const auto& [position, input] = analysis.stationary_variance_by_input.back();
    text += "of which radar " + figure(position, "m^2") + ", radio " + figure(input, "m^2") +
            formatted(" (follower %zu)\n", stationary.size());
  }
  const std::vector<double>& means = analysis.stationary_mean;
  const auto largest = std::max_element(means.begin(), means.end(),
                                        [](double one, double other) { return std::abs(one) < std::abs(other); });
  if (largest != means.end() && *largest != 0.0 && std::isfinite(*largest)) {
    text += formatted("Stationary mean: up to %.6g m, of follower %zu, caused by delay and loss at constant speed\n",
                      *largest, static_cast<std::size_t>(largest - means.begin()) + 1);
  }
  for (const std::string& contradiction : analysis.contradictions) text += contradiction_line(contradiction);
  text += report(configuration, analysis.signals);
  text += formatted(
      "Largest norms over %zu followers and %lld steps k (%s): ||mean||_2 = %s, ||variance||_inf = %s (of one follower sqrt(sum of mean(k)^2), and the largest variance(k))\n",
      analysis.moments.followers, static_cast<long long>(analysis.moments.steps),
      duration(analysis.moments.steps, model).c_str(),
      figure(sequence_norm(analysis.norms.mean.data(), analysis.norms.mean.size(), NormOrder::kInfinity), "m").c_str(),
      figure(sequence_norm(analysis.norms.variance.data(), analysis.norms.variance.size(), NormOrder::kInfinity), "m^2")
          .c_str());
  if (analysis.bounds) {
    const TheoremTwoBounds& bounds = *analysis.bounds;
    text += "Bounds of Theorem 2: mean " + figure(bounds.mean_bound, "m") + " (alpha_1 " + figure(bounds.alpha_1, "m") +
            ", beta_1 " + figure(bounds.beta_1, "m") + "), variance " + figure(bounds.variance_bound, "m^2") +
            " (alpha_2 " + figure(bounds.alpha_2, "m^2") + ", beta_2 " + figure(bounds.beta_2, "m^2") +
            "; the paper's beta_2 " + figure(bounds.stated_beta_2, "m^2") + ")\n";
  } else if (!is_papers(model)) {
    text += "Bounds of Theorem 2: none, as they apply to the paper's platoon only\n";
  } else {
    text += "Bounds of Theorem 2: none, as rho(A) is not below 1\n";
  }
  text += warning_lines(analysis.warnings);
  if (analysis.rounding > 1e-9) {
    text += formatted(
        "Warning: a run keeps a position of 1 m to %.1g m only, as the coefficients of A, B and C lose digits in double. The figures above do not lose them: they hold for the given, rounded numbers\n",
        analysis.rounding);
  }
  if (analysis.integral_defect > 1e-9) {
    text += formatted(
        "Warning: A, B and C have T(1) = 1 and dT/dz(1) = -h to %.1g only, which does not determine a verdict so near to its border, nor the limit to more digits\n",
        analysis.integral_defect);
  }
  return text;
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
  nlohmann::json headways, losses, by_input, bounds;
  if (analysis.headways) headways = pairs(analysis.headways->intervals);
  if (analysis.losses) losses = pairs(analysis.losses->intervals);
  const std::optional<double> critical = analysis.headways ? analysis.headways->critical : std::nullopt;
  nlohmann::json norms = {{"mean_l2", numbers(analysis.norms.mean)},
                          {"variance_linf", numbers(analysis.norms.variance)},
                          {"mean_bound", number(analysis.bounds ? analysis.bounds->mean_bound : std::nullopt)},
                          {"variance_bound", number(analysis.bounds ? analysis.bounds->variance_bound : std::nullopt)}};
  for (const std::array<double, 2>& shares : analysis.stationary_variance_by_input) {
    for (const std::size_t input : {0u, 1u}) by_input[input].push_back(number(shares[input]));
  }
  if (analysis.bounds) {
    bounds = {{"alpha_1", number(analysis.bounds->alpha_1)},
              {"beta_1", number(analysis.bounds->beta_1)},
              {"alpha_2", number(analysis.bounds->alpha_2)},
              {"beta_2", number(analysis.bounds->beta_2)},
              {"stated_beta_2", number(analysis.bounds->stated_beta_2)}};
  }
  nlohmann::json document = to_json(analysis.stability);
  document.update(to_json(analysis.robustness, model.sample_period));
  document.update(
      {{"sample_period", model.sample_period},
       {"transfer",
        {{"numerator", coefficients(own.loop.transfer.numerator())},
         {"denominator", coefficients(own.loop.transfer.denominator())}}},
       {"integral_defect", number(analysis.integral_defect)},
       {"critical_headway", number(critical)},
       {"critical_headway_seconds", critical ? nlohmann::json(*critical * model.sample_period) : nlohmann::json()},
       {"stable_headways", headways},
       {"critical_headway_types", analysis.headways ? nlohmann::json(analysis.headways->types) : nlohmann::json()},
       {"critical_mean_burst", number(analysis.bursts ? analysis.bursts->critical : std::nullopt)},
       {"critical_loss_probability", number(analysis.losses ? analysis.losses->critical : std::nullopt)},
       {"critical_loss_types", analysis.losses ? nlohmann::json(analysis.losses->types) : nlohmann::json()},
       {"stable_loss_probabilities", losses},
       {"stationary_mean", numbers(analysis.stationary_mean)},
       {"stationary_variance", numbers(analysis.stationary_variance)},
       {"stationary_variance_by_input", by_input},
       {"contradictions", analysis.contradictions},
       {"mean", rows(analysis.moments.mean, steps)},
       {"variance", rows(analysis.moments.variance, steps)},
       {"norms", norms},
       {"bounds", bounds}});
  return document;
}

}  // namespace

nlohmann::json to_json(const Configuration& configuration, const Analysis& analysis) {
  const VehicleModel& own = configuration.model.default_vehicle();
  nlohmann::json document = {{"headway", own.headway},
                             {"noise_variance", own.noise_variance},
                             {"theory", name_of_theory(!analysis.without_theory)},
                             {"rounding", number(analysis.rounding)},
                             {"warnings", analysis.warnings},
                             {"age_of_information", ages_to_json(configuration.model, configuration.run.followers)}};
  if (!analysis.without_theory) document.update(theory_to_json(configuration, analysis));
  add_to_json(configuration, analysis.signals, document);
  if (!analysis.linear) return document;
  const std::vector<double>& beyond = analysis.beyond_limits;
  document["linear"] = to_json(linear_configuration(configuration), *analysis.linear);
  document["linear"]["probability_beyond_input_limits"] =
      beyond.empty() ? nlohmann::json() : rows(beyond, static_cast<std::size_t>(configuration.run.steps));
  return document;
}

}  // namespace platoon
