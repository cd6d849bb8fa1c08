#include "stochastic_platoon/math/string/beyond_limits.hpp"

#include "stochastic_platoon/math/model/linear_model.hpp"
#include "stochastic_platoon/math/numerics/special_values.hpp"
#include "stochastic_platoon/math/statistics/normal_crossing.hpp"
#include "stochastic_platoon/math/string/signal_moments.hpp"

namespace platoon {

std::vector<double> probability_beyond_limits(const PlatoonModel& model, std::size_t followers, std::int64_t steps) {
  const PlatoonModel linear = without_limits(model, steps);
  require_normal_errors(linear);
  const SignalMoments input = signal_moments(linear, {kInput}, followers, steps).front();
  std::vector<double> probabilities;
  for (std::size_t c = 0; c < input.mean.size(); ++c) {
    const std::optional<Interval>& limits = vehicle(model, c / static_cast<std::size_t>(steps) + 1).limits.input;
    const double mean = input.mean[c], variance = input.variance[c];
    probabilities.push_back(limits ? probability_below_zero({mean - limits->lower, variance}) +
                                         probability_below_zero({limits->upper - mean, variance})
                                   : kNaN);
  }
  return probabilities;
}

}  // namespace platoon
