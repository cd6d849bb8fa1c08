#include "stochastic_platoon/analysis/prediction.hpp"

#include "stochastic_platoon/theory/error_moments.hpp"
#include "stochastic_platoon/theory/rounding_bound.hpp"
#include "stochastic_platoon/theory/stationary_variance.hpp"

namespace platoon {

Prediction predict(const Configuration& configuration) {
  const RunOptions& run = configuration.run;
  Prediction prediction{string_stability(configuration.model),
                        stationary_variances(configuration.model, run.followers),
                        {},
                        {}};
  if (run.averaging() == Averaging::over_time) {
    prediction.mean.assign(run.followers, 0.0);
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
