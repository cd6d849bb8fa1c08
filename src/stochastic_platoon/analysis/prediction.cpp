#include "stochastic_platoon/analysis/prediction.hpp"

#include <limits>

#include "stochastic_platoon/theory/error_moments.hpp"
#include "stochastic_platoon/theory/linked_string.hpp"
#include "stochastic_platoon/theory/rounding_bound.hpp"
#include "stochastic_platoon/theory/stationary_variance.hpp"

namespace platoon {

const char* to_string(Theory theory) {
  return theory == Theory::exact ? "exact" : "none";
}

Theory theory_of(const PlatoonModel& model) {
  for (const VehicleModel& vehicle : pattern(model)) {
    if (vehicle.link.loss && !vehicle.link.loss->is_independent()) return Theory::none;
  }
  return Theory::exact;
}

namespace {

Prediction no_prediction(const Configuration& configuration) {
  const RunOptions& run = configuration.run;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::size_t cells =
      run.followers * static_cast<std::size_t>(run.averaging() == Averaging::over_time ? 1 : run.steps);
  StringStability unknown{nan, nan, nan, false, false, false, {}, "none, as losses come in bursts"};
  return {unknown,
          std::vector<double>(run.followers, nan),
          std::vector<double>(cells, nan),
          std::vector<double>(cells, nan),
          {},
          Theory::none};
}

}  // namespace

Prediction predict(const Configuration& configuration) {
  if (theory_of(configuration.model) == Theory::none) return no_prediction(configuration);
  const RunOptions& run = configuration.run;
  Prediction prediction{string_stability(configuration.model),
                        stationary_variances(configuration.model, run.followers),
                        {},
                        {}};
  if (run.averaging() == Averaging::over_time) {
    prediction.mean = is_papers(configuration.model) ? std::vector<double>(run.followers, 0.0)
                                                     : stationary_means(configuration.model, run.followers);
    prediction.variance = prediction.stationary_variance;
  } else {
    ErrorMoments moments = error_moments(configuration.model, run.followers, run.steps);
    prediction.rounding = rounding_bounds(configuration.model, moments);
    prediction.mean.swap(moments.mean);
    prediction.variance.swap(moments.variance);
  }
  return prediction;
}

}  // namespace platoon
