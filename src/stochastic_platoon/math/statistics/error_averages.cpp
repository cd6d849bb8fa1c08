#include "stochastic_platoon/math/statistics/error_averages.hpp"

#include "stochastic_platoon/math/statistics/ensemble_statistics.hpp"
#include "stochastic_platoon/math/statistics/time_statistics.hpp"

namespace platoon {

std::unique_ptr<ErrorAverages> error_averages(const SignalCells& cells, std::int64_t burn_in,
                                              const EarlierAverages& earlier, KeptMoments kept) {
  if (cells.steps == 0) return std::make_unique<TimeStatistics>(cells.followers, burn_in, earlier.over_time);
  auto averages = std::make_unique<EnsembleStatistics>(cells, kept);
  if (earlier.over_realizations != nullptr) averages->merge(*earlier.over_realizations);
  return averages;
}

}  // namespace platoon
