#pragma once

#include <cmath>

#include "stochastic_platoon/run/results/run_result.hpp"
#include "unit/paper_run.hpp"

namespace platoon {

/// A result whose cells are all `score` standard errors away from the prediction.
inline RunResult result_with(const Configuration& configuration, const Prediction& prediction, double score = 0.5) {
  RunResult result;
  result.complete = true;
  result.realizations = configuration.run.realizations;
  result.tally = {positions_expected(configuration.run, result.realizations), 3, 0.5, 0};
  for (std::size_t c = 0; c < prediction.mean.size(); ++c) {
    const double n = static_cast<double>(result.realizations), v = prediction.variance[c];
    const double variance = v + score * standard_error_of_variance(v, result.realizations);
    result.moments.push_back({result.realizations,
                              prediction.mean[c] + score * standard_error_of_mean(v, result.realizations),
                              variance * (n - 1.0)});
  }
  return result;
}

/// The same with the third and fourth moments of normal errors, which the statistics of a lossy string include.
inline RunResult result_with_fourth_moments(const Configuration& configuration, const Prediction& prediction,
                                            double score = 0.5) {
  RunResult result = result_with(configuration, prediction, score);
  for (Moments& of : result.moments) {
    of.cubed_deviations = 0.0;
    of.fourth_deviations = 3.0 * of.variance() * of.variance() * static_cast<double>(of.count);
  }
  return result;
}

}  // namespace platoon
