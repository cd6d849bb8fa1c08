#include "stochastic_platoon/run/results/signal_results.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "stochastic_platoon/math/numerics/special_values.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/math/string/amplification.hpp"
#include "stochastic_platoon/run/report/plausibility.hpp"
#include "stochastic_platoon/run/report/signal_analysis.hpp"

namespace platoon {

namespace {

// The follower with the smallest gap, the first of equal ones; no follower without gaps.
std::size_t nearest_follower(const GapTable& gaps) {
  const std::vector<FollowerGaps>& all = gaps.followers();
  const auto nearest = std::min_element(all.begin(), all.end(), [](const FollowerGaps& a, const FollowerGaps& b) {
    return a.smallest.gap < b.smallest.gap;
  });
  return static_cast<std::size_t>(nearest - all.begin()) + 1;
}

bool has_signal_theory(const Prediction& prediction, std::size_t follower) {
  return !prediction.signals.empty() && follower <= prediction.followers_with_theory;
}

}  // namespace

void add_signal_theory(CsvText& csv, const Prediction& prediction, std::size_t signal, std::size_t follower,
                       std::size_t cell) {
  if (!has_signal_theory(prediction, follower)) return csv.add("", "");
  csv.add(prediction.signals[signal].mean[cell], prediction.signals[signal].variance[cell]);
}

std::optional<double> collision_bound(const Prediction& prediction, std::size_t follower) {
  const bool has_bound = has_signal_theory(prediction, follower) && !prediction.collision_bound.empty();
  return has_bound ? std::optional(prediction.collision_bound[follower - 1]) : std::nullopt;
}

std::vector<std::string> run_warnings(const Configuration& configuration, const Prediction& prediction,
                                      const RunResult& result) {
  const RunOptions& run = configuration.run;
  std::vector<SignalFigures> measured;
  for (std::size_t s = 0; s < result.signals.size(); ++s) {
    measured.push_back({run.signals[s], {}, {}});
    for (std::size_t c = 0; c < result.signals[s].size(); ++c) {
      const Moments& of = result.signals[s][c];
      const bool is_known = has_signal_theory(prediction, c / static_cast<std::size_t>(run.steps) + 1);
      measured.back().mean.push_back(is_known ? kNaN : of.known_mean());
      measured.back().variance.push_back(of.variance());
    }
  }
  std::vector<std::string> warnings = prediction.warnings;
  const auto is_of_first_steps = [&](const std::string& warning) {
    return prediction.signals.empty() && std::any_of(measured.begin(), measured.end(), [&](const SignalFigures& of) {
             return warning.rfind(of.name + ":", 0) == 0;
           });
  };
  warnings.erase(std::remove_if(warnings.begin(), warnings.end(), is_of_first_steps), warnings.end());
  const std::vector<std::string> motion = motion_warnings(configuration.model, measured, run.steps);
  warnings.insert(warnings.end(), motion.begin(), motion.end());
  return warnings;
}

std::string signals_csv(const Configuration& configuration, const Prediction& prediction, const RunResult& result) {
  const RunOptions& run = configuration.run;
  CsvText csv("signal,vehicle,step,count,mean,variance,theoretical_mean,theoretical_variance");
  csv.end_row();
  for (std::size_t s = 0; s < run.signals.size(); ++s) {
    for (std::size_t i = 1; i <= run.followers; ++i) {
      for (std::int64_t k = 0; k < run.steps; ++k) {
        const std::size_t c = cell(i, k, run.steps);
        const Moments& of = result.signals[s][c];
        csv.add(run.signals[s], i, k, of.count, of.known_mean(), of.variance());
        add_signal_theory(csv, prediction, s, i, c);
        csv.end_row();
      }
    }
  }
  return csv.text();
}

std::string limits_csv(const Configuration& configuration, const RunResult& result) {
  const RunOptions& run = configuration.run;
  const double steps = static_cast<double>(run.steps) * static_cast<double>(result.realizations);
  CsvText csv("vehicle,input_low,input_high,speed_low,speed_high");
  csv.end_row();
  for (std::size_t i = 1; i <= run.followers; ++i) {
    const VehicleLimits& limits = vehicle(configuration.model, i).limits;
    const AtLimits& at = result.limits.followers()[i - 1];
    const auto share = [&](std::size_t side) { return static_cast<double>(at[side]) / steps; };
    csv.add(i);
    csv.add_if(limits.input && !run.is_external(i), share(0), share(1));
    csv.add_if(limits.speed.has_value(), share(2), share(3));
    csv.end_row();
  }
  return csv.text();
}

std::string gaps_csv(const Configuration& configuration, const Prediction& prediction, const RunResult& result) {
  const GapCounting& counting = result.gaps.counting();
  const std::vector<FollowerGaps>& all = result.gaps.followers();
  std::set<std::int64_t> bins;
  for (const FollowerGaps& of : all) {
    for (const auto& [bin, count] : of.histogram) bins.insert(bin);
  }
  CsvText csv("vehicle,count,smallest_gap,realization,step,collisions,below_safe_gap,theoretical_collision_bound");
  for (const std::int64_t bin : bins) csv.add(formatted("bin_%.10g", static_cast<double>(bin) * counting.bin_width));
  csv.end_row();
  for (std::size_t i = 1; i <= configuration.run.followers; ++i) {
    const FollowerGaps& of = all[i - 1];
    csv.add(i, result.realizations, of.smallest.gap, of.smallest.realization, of.smallest.step, of.collisions,
            counting.safe_gap ? std::to_string(of.unsafe) : "", collision_bound(prediction, i));
    for (const std::int64_t bin : bins) {
      const auto found = of.histogram.find(bin);
      csv.add(found == of.histogram.end() ? 0 : found->second);
    }
    csv.end_row();
  }
  return csv.text();
}

namespace {

// The moments of n realizations as they are: without the factor n / (n - 1), mean^2 + variance is the mean square.
SignalRows measured_rows(const PlatoonModel& model, const std::string& name, const std::vector<Moments>& followers,
                         std::int64_t steps) {
  SignalRows rows{leader_signal(model, name, steps), std::vector<double>(static_cast<std::size_t>(steps), 0.0),
                  std::vector<double>(static_cast<std::size_t>(steps), 0.0)};
  for (const Moments& of : followers) {
    const auto count = static_cast<double>(of.count);
    rows.mean.push_back(of.known_mean());
    rows.variance.push_back(of.squared_deviations / count);
    rows.variance_of_mean.push_back(of.variance() / count);
  }
  return rows;
}

std::vector<Amplification> measured(const Configuration& configuration, const RunResult& result) {
  const RunOptions& run = configuration.run;
  SignalsByName signals;
  for (std::size_t s = 0; s < run.signals.size(); ++s) {
    if (run.signals[s] != kGap)
      signals[run.signals[s]] = measured_rows(configuration.model, run.signals[s], result.signals[s], run.steps);
  }
  return amplification(signals, run.steps, run.burn_in);
}

// One entry per vehicle; empty without a theory.
std::vector<Amplification> theoretical(const Configuration& configuration, const Prediction& prediction) {
  const RunOptions& run = configuration.run;
  const SignalsByName signals = exact_signals(configuration.model, run.signals, prediction.signals, run.steps);
  std::vector<Amplification> found = amplification(signals, run.steps, run.burn_in);
  found.resize(std::min(found.size(), prediction.followers_with_theory + 1));
  return found;
}

std::optional<double> finite(double value) {
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

}  // namespace

std::string amplification_csv(const Configuration& configuration, const Prediction& prediction,
                              const RunResult& result) {
  const std::vector<Amplification> of_run = measured(configuration, result),
                                   of_theory = theoretical(configuration, prediction);
  const std::vector<AmplificationFigure>& figures = amplification_figures();
  CsvText csv("vehicle");
  for (const AmplificationFigure& figure : figures) csv.add(figure.name);
  for (const AmplificationFigure& figure : figures) csv.add(std::string("theoretical_") + figure.name);
  csv.end_row();
  for (std::size_t i = 0; i < of_run.size(); ++i) {
    csv.add(i);
    for (const AmplificationFigure& figure : figures) csv.add(finite(of_run[i].*figure.value));
    for (const AmplificationFigure& figure : figures)
      csv.add(i < of_theory.size() ? finite(of_theory[i].*figure.value) : std::nullopt);
    csv.end_row();
  }
  return csv.text();
}

nlohmann::json smallest_gap_json(const RunResult& result) {
  if (result.gaps.empty() || result.realizations == 0) return {};
  const std::size_t vehicle = nearest_follower(result.gaps);
  const FollowerGaps& of = result.gaps.followers()[vehicle - 1];
  return {{"gap", of.smallest.gap},
          {"vehicle", vehicle},
          {"realization", of.smallest.realization},
          {"step", of.smallest.step}};
}

namespace {

std::string amplification_report(const Configuration& configuration, const Prediction& prediction,
                                 const RunResult& result) {
  const std::vector<Amplification> of_run = measured(configuration, result),
                                   of_theory = theoretical(configuration, prediction);
  const char* const hidden =
      result.realizations < 2 ? "one realization does not show how much is noise" : "noise hides it";
  std::string text = amplification_line(of_run, configuration.run.burn_in, hidden);
  const bool leader_moves = of_run.front().rms_mean_speed != 0.0;
  const std::string known = leader_moves && !of_theory.empty() ? largest_and_tail(of_theory) : "";
  if (!known.empty()) text += " (theory: " + known + ")";
  return text + "\n";
}

std::string gap_lines(const Configuration& configuration, const Prediction& prediction, const RunResult& result) {
  const std::size_t vehicle = nearest_follower(result.gaps);
  const FollowerGaps& of = result.gaps.followers()[vehicle - 1];
  std::string text = formatted("Smallest gap: %.6g m, follower %zu, realization %llu, %s\n", of.smallest.gap, vehicle,
                               static_cast<unsigned long long>(of.smallest.realization),
                               time_of_step(of.smallest.step, configuration.model).c_str());
  const std::vector<FollowerGaps>& all = result.gaps.followers();
  // The most collisions, of equal ones the greatest bound.
  std::size_t worst = 1;
  const auto rank = [&](std::size_t i) {
    return std::pair(all[i - 1].collisions, collision_bound(prediction, i).value_or(0.0));
  };
  for (std::size_t i = 2; i <= all.size(); ++i) {
    if (rank(i) > rank(worst)) worst = i;
  }
  const auto collisions = static_cast<unsigned long long>(all[worst - 1].collisions);
  const auto realizations = static_cast<unsigned long long>(result.realizations);
  text += collisions == 0
              ? formatted("Collisions (a gap below 0): in none of %llu realizations", realizations)
              : formatted("Collisions (a gap below 0): in %llu of %llu realizations of follower %zu, the most",
                          collisions, realizations, worst);
  if (const std::optional<double> bound = collision_bound(prediction, worst))
    text += formatted("; by theory at most a share of %.6g (follower %zu)", *bound, worst);
  text += "\n";
  if (configuration.run.external.empty() && result.complete && !configuration.run.output.empty()) {
    const std::string realization = std::to_string(of.smallest.realization), &output = configuration.run.output;
    text += "To replay it: rosrun stochastic_platoon monte_carlo --repeat " + shell_word(output + "/summary.json") +
            " --only " + realization + " --trajectories --output " +
            shell_word(output + "/realization_" + realization) + "\n";
  }
  return text;
}

}  // namespace

std::string signals_report(const Configuration& configuration, const Prediction& prediction, const RunResult& result) {
  const RunOptions& run = configuration.run;
  std::string text;
  for (std::size_t s = 0; s < result.signals.size(); ++s) {
    const std::size_t last = cell(run.followers, run.steps - 1, run.steps);
    const Moments& of = result.signals[s][last];
    const char* const unit = unit_of(run.signals[s]);
    text += formatted("%s of follower %zu at %s: mean %.6g %s", in_words(run.signals[s]).c_str(), run.followers,
                      time_of_step(run.steps - 1, configuration.model).c_str(), of.mean, unit);
    if (of.count > 1) text += formatted(", standard deviation %.6g %s", std::sqrt(of.variance()), unit);
    if (has_signal_theory(prediction, run.followers))
      text += formatted(" (theory %.6g, %.6g)", prediction.signals[s].mean[last],
                        std::sqrt(prediction.signals[s].variance[last]));
    if (const std::optional<Agreement> found = signal_agreement(run, prediction, result, s))
      text += (found->agrees() ? ", agrees" : ", DISAGREES WITH THE THEORY") + largest_score(*found);
    text += prediction.signals.empty() ? " (measured only)\n" : "\n";
  }
  if (!result.signals.empty() && run.has_amplification())
    text += amplification_report(configuration, prediction, result);
  if (!result.gaps.empty() && result.realizations > 0) text += gap_lines(configuration, prediction, result);
  return text;
}

}  // namespace platoon
