#include "stochastic_platoon/results/run_result.hpp"

#include <cmath>

#include "stochastic_platoon/model/tracking_error.hpp"
#include "stochastic_platoon/model/vehicle.hpp"
#include "stochastic_platoon/results/atomic_file.hpp"
#include "stochastic_platoon/results/text.hpp"
#include "stochastic_platoon/statistics/ensemble_statistics.hpp"

namespace platoon {

namespace {

Agreement measured_agreement(const Prediction& prediction, const RunResult& result) {
  return agreement(result.moments, prediction.mean, prediction.variance);
}

nlohmann::json theory_json(const Prediction& prediction) {
  const StringStability& stability = prediction.stability;
  nlohmann::json limit;
  if (stability.limit_variance) limit = *stability.limit_variance;
  return {{"spectral_radius", stability.spectral_radius},          {"peak_gain", stability.peak_gain},
          {"mean_square_stable", stability.mean_square_stable},    {"string_stable", stability.string_stable},
          {"stationary_variance", prediction.stationary_variance}, {"limit_variance", limit}};
}

nlohmann::json summary_json(const Configuration& configuration, const Prediction& prediction,
                            const RunResult& result) {
  const RunOptions& run = configuration.run;
  const bool time_average = run.steps == 0;
  nlohmann::json agreement_json = {{"max_abs_z_mean", nullptr}, {"max_abs_z_variance", nullptr}};
  if (!time_average && result.realizations > 1) {
    const Agreement found = measured_agreement(prediction, result);
    agreement_json = {{"max_abs_z_mean", found.max_abs_z_mean},
                      {"max_abs_z_variance", found.max_abs_z_variance}};
  }
  const double vehicle_steps = static_cast<double>(run.followers) *
                               static_cast<double>(time_average ? result.last_step + 1 : run.steps) *
                               static_cast<double>(result.realizations);
  const std::uint64_t received = result.tally.positions_received;
  const std::uint64_t expected = time_average ? received : positions_expected(run, result.realizations);
  return {{"complete", result.complete},
          {"followers", run.followers},
          {"steps", run.steps},
          {"time_average", time_average},
          {"realizations", result.realizations},
          {"seed", run.seed},
          {"hosting", run.hosting},
          {"attempts", result.tally.attempts},
          {"positions_received", received},
          {"positions_lost", static_cast<std::int64_t>(expected) - static_cast<std::int64_t>(received)},
          {"wall_seconds", result.tally.wall_seconds},
          {"vehicle_steps_per_second",
           result.tally.wall_seconds > 0.0 ? vehicle_steps / result.tally.wall_seconds : 0.0},
          {"agreement", agreement_json},
          {"theory", theory_json(prediction)}};
}

// Which rows a terminal can take: all of a short string, the two ends of a long one.
bool is_shown(std::size_t follower, std::size_t followers) {
  return followers <= 30 || follower <= 10 || follower + 10 > followers;
}

std::string table(const Configuration& configuration, const Prediction& prediction, const RunResult& result) {
  const RunOptions& run = configuration.run;
  const bool time_average = run.steps == 0;
  std::string text =
      time_average ? formatted(
                         "time averages up to step %lld (variance over time, no standard error: successive "
                         "errors are correlated)\n",
                         static_cast<long long>(result.last_step))
                   : formatted("tracking errors at step %lld, %llu realizations\n",
                               static_cast<long long>(run.steps - 1),
                               static_cast<unsigned long long>(result.realizations));
  text += "follower   variance [m^2]   standard error   theory [m^2]         z\n";
  for (std::size_t i = 1; i <= run.followers; ++i) {
    if (!is_shown(i, run.followers)) {
      if (is_shown(i - 1, run.followers)) text += "     ...\n";
      continue;
    }
    const std::size_t c = time_average ? i - 1 : cell(i, run.steps - 1, run.steps);
    const Moments& moments = result.moments[c];
    const double theory = prediction.variance[c];
    text += formatted("%8zu %16.6g ", i, moments.variance());
    text += time_average
                ? formatted("%16s %14.6g %9s\n", "-", theory, "-")
                : formatted("%16.2g %14.6g %9.2f\n", standard_error_of_variance(theory, moments.count),
                            theory, scores(moments, prediction.mean[c], theory).variance);
  }
  return text;
}

// The mean of the errors behind a given leader: the platoon without noise and with the mean initial
// positions, as it is linear.
std::vector<double> noise_free_errors(const Configuration& configuration, std::vector<double> predecessor) {
  PlatoonModel model = configuration.model;
  model.initial_position.variance = 0.0;
  const TrackingError error{model.headway, model.standstill_distance};
  std::vector<double> errors;
  for (std::uint32_t i = 1; i <= configuration.run.followers; ++i) {
    FollowerVehicle follower(model, configuration.run.seed, i);
    std::vector<double> own(1), positions;
    follower.start(0, 1, own);
    positions.push_back(own.front());
    for (std::size_t k = 0; k + 1 < predecessor.size(); ++k) {
      follower.step({predecessor[k]}, own);
      errors.push_back(error(predecessor[k + 1], own.front(), positions.back()));
      positions.push_back(own.front());
    }
    predecessor.swap(positions);
  }
  return errors;
}

}  // namespace

Prediction predict(const Configuration& configuration, const std::vector<double>& leader_positions) {
  const RunOptions& run = configuration.run;
  Prediction prediction{string_stability(configuration.model),
                        stationary_variances(configuration.model, run.followers),
                        {},
                        {}};
  if (run.steps == 0) {
    prediction.mean.assign(run.followers, 0.0);
    prediction.variance = prediction.stationary_variance;
  } else {
    ErrorMoments moments = error_moments(configuration.model, run.followers, run.steps);
    prediction.mean.swap(moments.mean);
    prediction.variance.swap(moments.variance);
    if (!leader_positions.empty()) prediction.mean = noise_free_errors(configuration, leader_positions);
  }
  return prediction;
}

std::uint64_t positions_expected(const RunOptions& run, std::uint64_t realizations) {
  return (run.followers + 1) * static_cast<std::uint64_t>(run.steps + 1) * realizations;
}

namespace {

// Of a time average each vehicle has its own: when a run is stopped, they are not all at the same step.
std::int64_t last_averaged_step(const RunOptions& run, const Moments& moments) {
  return run.burn_in + static_cast<std::int64_t>(moments.count) - 1;
}

}  // namespace

std::string statistics_csv(const Configuration& configuration, const Prediction& prediction,
                           const RunResult& result) {
  const bool time_average = configuration.run.steps == 0;
  const std::int64_t steps = time_average ? 1 : configuration.run.steps;
  std::string text = "vehicle,step,count,mean,variance,theoretical_mean,theoretical_variance\n";
  for (std::size_t i = 1; i <= configuration.run.followers; ++i) {
    for (std::int64_t k = 0; k < steps; ++k) {
      const std::size_t c = cell(i, k, steps);
      const Moments& moments = result.moments[c];
      text += formatted(
          "%zu,%lld,%llu,%.17g,%.17g,%.17g,%.17g\n", i,
          static_cast<long long>(time_average ? last_averaged_step(configuration.run, moments) : k),
          static_cast<unsigned long long>(moments.count), moments.count > 0 ? moments.mean : std::nan(""),
          moments.variance(), prediction.mean[c], prediction.variance[c]);
    }
  }
  return text;
}

void write_results(const Configuration& configuration, const Prediction& prediction,
                   const RunResult& result) {
  const std::string& output = configuration.run.output;
  write_atomically(output + "/statistics.csv", statistics_csv(configuration, prediction, result));
  write_atomically(output + "/summary.json", summary_json(configuration, prediction, result).dump(2) + "\n");
}

std::string report(const Configuration& configuration, const Prediction& prediction,
                   const RunResult& result) {
  const RunOptions& run = configuration.run;
  const StringStability& stability = prediction.stability;
  std::string text = formatted("\nPlatoon of %zu followers, h = %g, P_d = %g m^2: ", run.followers,
                               configuration.model.headway, configuration.model.noise_variance);
  text += table(configuration, prediction, result);
  if (run.steps > 0 && result.realizations > 1) {
    const Agreement found = measured_agreement(prediction, result);
    const double bound = largest_plausible_score(2 * result.moments.size());
    const bool agrees = found.max_abs_z_mean <= bound && found.max_abs_z_variance <= bound;
    text += formatted(
        "%s: over all %zu (i, k) the largest |z| is %.2f for the means and %.2f for the variances "
        "(chance alone exceeds %.2f once in 1000 runs)\n",
        agrees ? "Measurement agrees with Lemma 1" : "MEASUREMENT AND LEMMA 1 DISAGREE",
        result.moments.size(), found.max_abs_z_mean, found.max_abs_z_variance, bound);
  }
  text += "Theory: " + stability.reason + ".\n";
  if (stability.limit_variance) {
    text += formatted("Stationary variance along an endless string: %.6g m^2\n", *stability.limit_variance);
  }
  return text;
}

}  // namespace platoon
