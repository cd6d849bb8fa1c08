#include "stochastic_platoon/run/report/analysis_report.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "stochastic_platoon/math/links/linked_pattern.hpp"
#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/model/loop_assumptions.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/run/report/age_analysis.hpp"
#include "stochastic_platoon/run/report/figure.hpp"
#include "stochastic_platoon/run/report/linear_theory.hpp"
#include "stochastic_platoon/run/report/plausibility.hpp"
#include "stochastic_platoon/run/report/string_text.hpp"

namespace platoon {

namespace {

std::string shown(const std::vector<HeadwayInterval>& intervals, double unit = 1.0) {
  std::string text;
  for (const HeadwayInterval& interval : intervals)
    text += formatted(" [%.6g, %.6g]", interval.from * unit, interval.to * unit);
  return text.empty() ? " none" : text;
}

/// " of default, truck": the given types, or the first of many, if the string has several; else empty.
std::string of_types(const PlatoonModel& model, const std::vector<std::string>& types) {
  constexpr std::size_t kMost = 8;
  if (is_homogeneous(model)) return "";
  const std::size_t shown = types.size() > kMost ? kMost / 2 : types.size();
  std::string text;
  for (std::size_t t = 0; t < shown; ++t) text += (text.empty() ? " of " : ", ") + types[t];
  return shown < types.size() ? text + formatted(" and %zu others", types.size() - shown) : text;
}

/// The gain that verdicts judge, and what it leads from and to.
std::string judged_gain(const PlatoonModel& model) {
  if (!hears_predecessors_only(model)) return "the gain along the string";
  return gain_name(model) + ", the " + (loses(model) ? "mean " : "") + "gain from " +
         (pattern(model).size() > 1 ? "the position in front of the string's pattern to that of its last vehicle"
                                    : "a vehicle's position to its follower's");
}

std::string peak_line(const PlatoonModel& model, const StringStability& stability) {
  return "Peak of " + judged_gain(model) + ": " +
         (std::isnan(stability.peak_gain) ? "none, as the errors do not settle\n"
                                          : formatted("%.9g at w = ", stability.peak_gain) +
                                                frequency_text(stability.peak_frequency, model.sample_period) + "\n");
}

std::string headway_line(const PlatoonModel& model, const Analysis& analysis) {
  if (!analysis.headways) {
    const bool followed = !types_with_default(model, &Inherited::headway).empty();
    return std::string("Critical headway: none, as ") +
           (model.default_vehicle().constant_spacing ? "the spacing is constant\n"
            : followed                               ? "the closed loop itself was given and fits one headway\n"
                                                     : "no vehicle of the string follows the default headway\n");
  }
  const StableHeadways& headways = *analysis.headways;
  const double unit = model.sample_period;
  const std::string critical =
      headways.critical ? formatted("%.9g s (%.9g sample periods)", *headways.critical * unit, *headways.critical)
      : headways.intervals.empty() ? "none"
                                   : "none, as the longest are not string stable";
  return "Critical headway" + of_types(model, headways.types) + ": " + critical +
         formatted("; string stable headways within [%.6g, %.6g] s:", headways.searched.from * unit,
                   headways.searched.to * unit) +
         shown(headways.intervals, unit) + "\n";
}

std::string loss_line(const PlatoonModel& model, const Analysis& analysis) {
  const std::optional<LossModel>& own_loss = model.default_vehicle().varied_link().loss;
  if (own_loss && own_loss->markov) return "Critical loss probability: none, as a chain of states loses\n";
  if (!analysis.losses) return "Critical loss probability: none, as no vehicle of the string follows the default one\n";
  const std::optional<double> critical = analysis.losses->critical;
  const VehicleModel& own = model.default_vehicle();
  const Input& varied = own.inputs[own.varied_inputs().front()];
  const std::string of = !own.hears_predecessor_only() ? " of " + text_of(varied)
                         : own.radio() != nullptr      ? " by radio"
                                                       : "";
  return "Critical loss probability" + of_types(model, analysis.losses->types) + of +
         (varied.link.loss
              ? ": "
              : std::string(" (a lost ") + name_of(varied.signal) + " is replaced by the last one received): ") +
         (critical ? formatted("%.9g", *critical) : "none") +
         formatted("; string stable loss probabilities within [0, %.6g]%s:", analysis.losses->largest,
                   varied.link.loss && varied.link.loss->mean_burst ? " at this mean burst" : "") +
         shown(analysis.losses->intervals) + "\n";
}

/// "of which radar 0.004 m^2, radio 0.001 m^2 (follower 20)".
std::string shares_line(const PlatoonModel& model, const std::vector<std::vector<double>>& shares) {
  if (shares.empty()) return "";
  const std::vector<VehicleModel> vehicles = pattern(model);
  std::string text = "of which ";
  for (std::size_t n = 0; n < shares.back().size(); ++n) {
    std::set<std::string> names;  // a share is the sum over all vehicles ahead
    for (const VehicleModel& of : vehicles) {
      if (n >= of.inputs.size()) continue;
      names.insert(of.hears_predecessor_only() ? (n == 0 ? "radar" : "radio") : text_of(of.inputs[n]));
    }
    const std::string name = names.size() == 1 ? *names.begin() : "input " + std::to_string(n);
    text += (n > 0 ? ", " : "") + name + " " + figure(shares.back()[n], "m^2");
  }
  return text + formatted(" (follower %zu)\n", shares.size());
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

std::string leader_share_line(const PlatoonModel& model, const Analysis& analysis) {
  if (!analysis.leader_shares) return "";
  const StableLeaderShares& shares = *analysis.leader_shares;
  return "Critical weight of the leader's position" + of_types(model, shares.types) + ": " +
         (shares.critical ? formatted("%.9g", *shares.critical) : "none") +
         "; string stable weights within [0, 1]:" + shown(shares.intervals) + "\n";
}

}  // namespace

std::string report(const Configuration& configuration, const Analysis& analysis) {
  const PlatoonModel& model = configuration.model;
  const StringStability& stability = analysis.stability;
  std::string text = string_text(model) + ": ";
  if (analysis.without_theory) {
    text += "no theory, as " + *analysis.without_theory + ": monte_carlo measures their effect\n" + age_report(model) +
            report(configuration, analysis.signals) + warning_lines(analysis.warnings);
    if (!analysis.linear) return text;
    Analysis linear = *analysis.linear;
    const auto is_shown = [&above = analysis.warnings](const std::string& warning) {
      return std::find(above.begin(), above.end(), warning) != above.end();
    };
    linear.warnings.erase(std::remove_if(linear.warnings.begin(), linear.warnings.end(), is_shown),
                          linear.warnings.end());
    text += "The same cars without limits (linear): " + report(linear_configuration(configuration), linear) +
            beyond_limits_report(configuration, analysis.beyond_limits);
    return text;
  }
  text += stability.reason + "\n";
  text += "rho(A) = " + beside_one(stability.spectral_radius) + ": the errors' mean and variance " +
          (stability.mean_square_stable ? "settle" : "DO NOT SETTLE") + " over time\n";
  text += peak_line(model, stability) + report(model, analysis.robustness) + headway_line(model, analysis) +
          loss_line(model, analysis) + burst_line(model, analysis) + leader_share_line(model, analysis) +
          age_report(model);
  const std::vector<double>& stationary = analysis.stationary_variance;
  const std::string& missing = analysis.not_computed;
  const bool none_is_computed = !missing.empty() && std::isnan(stationary.front());
  text += "Stationary variance" + speed_text(configuration) + ": ";
  if (!none_is_computed)
    text += figure(stationary.front(), "m^2") + " of follower 1, " + figure(stationary.back(), "m^2") +
            formatted(" of follower %zu; of an endless string: ", stationary.size());
  text += (missing.empty() ? figure(stability.limit_variance, "m^2") : missing) + "\n";
  if (!none_is_computed) text += shares_line(model, analysis.stationary_variance_by_input);
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
      "Largest norms over %zu followers and %s: ||mean||_2 = %s, ||variance||_inf = %s (of one follower sqrt(sum of mean(k)^2), and the largest variance(k))\n",
      analysis.moments.followers, duration_in_steps(analysis.moments.steps, model).c_str(),
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
        "Warning: a run keeps a position of 1 m to %.1g m only, as the closed loop's matrices A, B and C lose digits in double. The figures above do not lose them: they hold for the given, rounded numbers\n",
        analysis.rounding);
  }
  if (analysis.integral_defect > 1e-9) {
    text += formatted(
        "Warning: the closed loop's matrices A, B and C have T(1) = 1 and dT/dz(1) = -h to %.1g only, which does not determine a verdict so near to its border, nor the limit to more digits\n",
        analysis.integral_defect);
  }
  return text;
}

}  // namespace platoon
