#include "stochastic_platoon/run/results/run_report.hpp"

#include <algorithm>
#include <cmath>

#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/run/report/figure.hpp"
#include "stochastic_platoon/run/report/plausibility.hpp"
#include "stochastic_platoon/run/report/string_text.hpp"
#include "stochastic_platoon/run/results/no_verdict.hpp"
#include "stochastic_platoon/run/results/signal_results.hpp"

namespace platoon {

namespace {

// Rows that fit a terminal: all of a short string, both ends of a long one.
bool is_shown(std::size_t follower, std::size_t followers) {
  return followers <= 30 || follower <= 10 || follower + 10 > followers;
}

std::string heading(const Configuration& configuration, const Prediction& prediction, const RunResult& result) {
  const RunOptions& run = configuration.run;
  const auto at = [&](std::int64_t step) { return time_of_step(step, configuration.model); };
  if (run.averaging() == Averaging::over_realizations) {
    return "tracking errors at " + at(run.steps - 1) +
           formatted(", %llu realizations\n", static_cast<unsigned long long>(result.realizations));
  }
  const std::int64_t counted = *std::min_element(result.last_steps.begin(), result.last_steps.end());
  std::string text =
      "time averages" + (counted < 0 ? "" : " up to " + at(counted)) +
      (counted < result.last_step ? ", paused at " + at(result.last_step) : "") +
      formatted(", behind a burn-in of %s: variance over time%s\n",
                duration_in_steps(run.burn_in, configuration.model).c_str(),
                prediction.warning.empty() ? "; standard errors include the correlation of successive errors"
                                           : "");  // else there are none
  if (result.tally.attempts > 1)
    text += formatted("the run was begun %u times, each time with a burn-in and new noise\n", result.tally.attempts);
  return text;
}

// "-" for a number that is not known.
std::string column(const char* format, int width, double value) {
  return formatted("%*s", width, std::isnan(value) ? "-" : formatted(format, value).c_str());
}

std::string row(const ResultCell& of) {
  return formatted("%8zu ", of.follower) + column("%.6g", 16, of.measured.variance()) +
         column("%.2g", 17, standard_error_of_variance(of)) + column("%.6g", 15, of.theoretical_variance) +
         column("%.2f", 10, scores(of).variance) + "\n";
}

std::string table(const RunOptions& run, const Prediction& prediction, const RunResult& result) {
  std::string text = "follower   variance [m^2]   standard error   theory [m^2]         z\n";
  for (const ResultCell& of : ResultCells(run, prediction, result).at(run.steps - 1)) {
    if (is_shown(of.follower, run.followers)) {
      text += row(of);
    } else if (is_shown(of.follower - 1, run.followers)) {
      text += "     ...\n";
    }
  }
  return text;
}

std::string comparison(const Agreement& found, std::size_t cells, const char* of, bool papers) {
  const std::string verdict = found.agrees()
                                  ? std::string("Measurement agrees with ") + (papers ? "Lemma 1" : "the theory")
                                  : std::string("MEASUREMENT AND ") + (papers ? "LEMMA 1" : "THE THEORY") + " DISAGREE";
  if (found.means_only)
    return formatted(
        "%s in the means: over all %zu %s the largest |z| is %.2f (chance alone exceeds %.2f at most once in 1000 runs)\n",
        verdict.c_str(), cells, of, found.max_abs_z_mean, found.plausible_z);
  return formatted(
      "%s: over all %zu %s the largest |z| is %.2f for the means and %.2f for the variances (chance alone exceeds %.2f at most once in 1000 runs)\n",
      verdict.c_str(), cells, of, found.max_abs_z_mean, found.max_abs_z_variance, found.plausible_z);
}

}  // namespace

std::string report(const Configuration& configuration, const Prediction& prediction, const RunResult& result) {
  const RunOptions& run = configuration.run;
  const StringStability& stability = prediction.stability;
  std::string text = formatted("\nPlatoon of %zu followers, ", run.followers) + string_text(configuration.model) + ": ";
  text += heading(configuration, prediction, result) + table(run, prediction, result);
  const std::optional<Agreement> found = measured_agreement(run, prediction, result);
  if (found) {
    text +=
        comparison(*found, cells_with_theory(run, prediction),
                   run.averaging() == Averaging::over_time ? "followers" : "(i, k)", is_papers(configuration.model));
  }
  const std::optional<std::string> reason =
      found ? std::nullopt : reason_of_no_verdict(configuration, prediction, result);
  if (reason && *reason != prediction.warning) text += "No verdict: " + *reason + "\n";
  text += signals_report(configuration, prediction, result);
  text += warning_lines(run_warnings(configuration, prediction, result));
  if (!prediction.warning.empty()) text += "Warning: " + prediction.warning + ".\n";
  text += "Theory: " + stability.reason + ".\n";
  for (const std::string& contradiction : prediction.contradictions) text += contradiction_line(contradiction);
  if (const std::optional<std::string> growth = measured_growth(configuration, prediction, result))
    text += "MEASUREMENT AND VERDICT DISAGREE: " + *growth + "\n";
  if (stability.limit_variance) {
    text += "Stationary variance along an endless string" + speed_text(configuration) +
            formatted(": %.6g m^2\n", *stability.limit_variance);
  }
  return text;
}

}  // namespace platoon
