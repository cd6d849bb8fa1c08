#pragma once

#include <gtest/gtest.h>

#include <cmath>

#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/run/results/run_result.hpp"
#include "unit/paper_run.hpp"
#include "unit/temporary_folder.hpp"

namespace platoon {

/// The moments of `count` values, `score` standard errors away from those of the theory.
inline std::vector<Moments> moments_with(const std::vector<double>& mean, const std::vector<double>& variance,
                                         std::uint64_t count, double score) {
  std::vector<Moments> all;
  for (std::size_t c = 0; c < mean.size(); ++c) {
    const double measured = variance[c] + score * standard_error_of_variance(variance[c], count);
    all.push_back({count, mean[c] + score * standard_error_of_mean(variance[c], count),
                   measured * (static_cast<double>(count) - 1.0)});
  }
  return all;
}

/// A result whose cells are all `score` standard errors away from the prediction.
inline RunResult result_with(const Configuration& configuration, const Prediction& prediction, double score = 0.5) {
  RunResult result;
  result.complete = true;
  result.realizations = configuration.run.realizations;
  result.tally = {positions_expected(configuration.run, result.realizations), 3, 0.5, 0};
  result.moments = moments_with(prediction.mean, prediction.variance, result.realizations, score);
  for (const SignalMoments& of : prediction.signals)
    result.signals.push_back(moments_with(of.mean, of.variance, result.realizations, score));
  return result;
}

/// Averages over 800 steps of two followers.
inline RunResult result_over_time() {
  RunResult result;
  result.realizations = 1;
  result.last_step = 998;
  result.moments = {Moments{800, 0.1, 79.9}, Moments{800, 0.2, 159.8}};
  result.last_steps = {999, 998};
  return result;
}

/// A run of the paper's example with its theory.
class ResultTest : public testing::Test {
protected:
  void predict_again() { prediction_ = predict(configuration_); }

  /// Averages over time behind a burn-in of 200 steps, instead of over realizations.
  void make_endless() {
    configuration_.run.steps = 0;
    configuration_.run.realizations = 1;
    configuration_.run.burn_in = 200;
    predict_again();
  }

  /// Leaves the platoon without any randomness.
  void make_quiet() {
    configuration_.model.default_vehicle().position().noise_variance = 0.0;
    configuration_.model.default_vehicle().initial_position.variance = 0.0;
    predict_again();
  }

  void lose_packets(const LossModel& loss) {
    configuration_.model.default_vehicle().position().link.loss = loss;
    predict_again();
  }

  RunResult result(double score = 0.5) const { return result_with(configuration_, prediction_, score); }

  /// The same with the third and fourth moments of normal errors, which the statistics of a lossy string include.
  RunResult result_with_fourth_moments() const {
    RunResult found = result();
    for (Moments& of : found.moments) {
      of.cubed_deviations = 0.0;
      of.fourth_deviations = 3.0 * of.variance() * of.variance() * static_cast<double>(of.count);
    }
    return found;
  }

  TemporaryFolder folder_;
  Configuration configuration_ = paper_run(folder_.path());
  Prediction prediction_ = predict(configuration_);
};

}  // namespace platoon
