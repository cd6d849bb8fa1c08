#include "stochastic_platoon/math/statistics/error_averages.hpp"

#include "stochastic_platoon/math/statistics/ensemble_statistics.hpp"
#include "stochastic_platoon/math/statistics/time_statistics.hpp"

namespace platoon {

std::unique_ptr<ErrorAverages> error_averages(std::size_t followers, std::int64_t steps, std::int64_t burn_in,
                                              const EarlierAverages& earlier, KeptMoments kept) {
  if (steps == 0) return std::make_unique<TimeStatistics>(followers, burn_in, earlier.over_time);
  auto averages = std::make_unique<EnsembleStatistics>(followers, steps, kept);
  if (earlier.over_realizations != nullptr) averages->merge(*earlier.over_realizations);
  return averages;
}

}  // namespace platoon
