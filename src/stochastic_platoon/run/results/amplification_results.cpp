#include "stochastic_platoon/run/results/amplification_results.hpp"

#include <algorithm>
#include <cmath>

#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/math/string/amplification.hpp"
#include "stochastic_platoon/run/report/signal_analysis.hpp"

namespace platoon {

namespace {

// The moments of n realizations as they are: without the factor n / (n - 1), mean^2 + variance is the mean square.
SignalRows measured_rows(const PlatoonModel& model, const std::string& name, const std::vector<Moments>& followers,
                         std::int64_t steps) {
  SignalRows rows{leader_signal(model, name, steps), std::vector<double>(static_cast<std::size_t>(steps), 0.0),
                  std::vector<double>(static_cast<std::size_t>(steps), 0.0)};
  for (const Moments& of : followers) {
    const auto count = static_cast<double>(of.count);
    rows.mean.push_back(of.count > 0 ? of.mean : std::nan(""));
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
  SignalsByName signals;
  for (std::size_t s = 0; s < prediction.signals.size(); ++s) {
    if (run.signals[s] != kGap)
      signals[run.signals[s]] = with_leader(configuration.model, run.signals[s], prediction.signals[s], run.steps);
  }
  std::vector<Amplification> found = amplification(signals, run.steps, run.burn_in);
  found.resize(std::min(found.size(), prediction.followers_with_theory + 1));
  return found;
}

std::string cell_text(double value) {
  return std::isfinite(value) ? formatted(",%.17g", value) : ",";
}

}  // namespace

std::string amplification_csv(const Configuration& configuration, const Prediction& prediction,
                              const RunResult& result) {
  const std::vector<Amplification> of_run = measured(configuration, result),
                                   of_theory = theoretical(configuration, prediction);
  std::string text = "vehicle";
  for (const AmplificationFigure& figure : amplification_figures()) text += std::string(",") + figure.name;
  for (const AmplificationFigure& figure : amplification_figures()) text += std::string(",theoretical_") + figure.name;
  text += "\n";
  for (std::size_t i = 0; i < of_run.size(); ++i) {
    text += std::to_string(i);
    for (const AmplificationFigure& figure : amplification_figures()) text += cell_text(of_run[i].*figure.value);
    for (const AmplificationFigure& figure : amplification_figures())
      text += i < of_theory.size() ? cell_text(of_theory[i].*figure.value) : ",";
    text += "\n";
  }
  return text;
}

std::string amplification_report(const Configuration& configuration, const Prediction& prediction,
                                 const RunResult& result) {
  const std::vector<Amplification> of_run = measured(configuration, result),
                                   of_theory = theoretical(configuration, prediction);
  if (of_run.front().rms_mean_speed == 0.0) return no_amplification(configuration.run.burn_in);
  const std::string found = largest_and_tail(of_run);
  const char* const hidden =
      result.realizations < 2 ? "none, as one realization does not show how much is noise" : "none, as noise hides it";
  std::string text = "Amplification of the speed (L2): " + (found.empty() ? hidden : found);
  if (!of_theory.empty()) text += " (theory: " + largest_and_tail(of_theory) + ")";
  return text + "\n";
}

}  // namespace platoon
