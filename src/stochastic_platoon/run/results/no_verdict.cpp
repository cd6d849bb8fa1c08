#include "stochastic_platoon/run/results/no_verdict.hpp"

#include <cmath>

#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"

namespace platoon {

namespace {

// "29000": rounded up to two digits.
std::string about(double number) {
  const double unit = std::pow(10.0, std::floor(std::log10(number)) - 1.0);
  return formatted(number < 1e15 ? "%.0f" : "%.2g", std::ceil(number / unit) * unit);
}

std::string of_few_realizations(std::uint64_t realizations, std::optional<double> needed) {
  const std::string given =
      std::to_string(realizations) + (realizations == 1 ? " realization is" : " realizations are");
  if (!needed) return given + " too few: 2 are needed";
  return "the tracking errors are not normal, and " + given + " too few to tell a difference from chance: " +
         (std::isfinite(*needed) ? "about " + about(*needed) + " are needed, as far as these tell"
                                 : "no number is enough, as a fourth moment leaves the range of double");
}

std::string of_averages(const Configuration& configuration, const Prediction& prediction, const RunResult& result) {
  const RunOptions& run = configuration.run;
  for (const ResultCell& of : ResultCells(run, prediction, result).at(run.steps - 1)) {
    if (of.follower > prediction.followers_with_theory || !std::isnan(of.share.expected)) continue;
    return std::string(loses(configuration.model)
                           ? "packets are lost, and averages over time may lack the rarest losses"
                           : "the standard errors are measured, by batch means of the run") +
           "; monte_carlo compares such a string with its theory";
  }
  return "the averages are worth fewer than 1000 independent errors so far";
}

}  // namespace

std::optional<std::string> reason_of_no_verdict(const Configuration& configuration, const Prediction& prediction,
                                                const RunResult& result) {
  if (!prediction.has_theory() || result.moments.empty()) return std::nullopt;
  if (!prediction.warning.empty() && !prediction.means_only) return prediction.warning;
  const RunOptions& run = configuration.run;
  if (run.averaging() == Averaging::over_time) return of_averages(configuration, prediction, result);
  return of_few_realizations(result.realizations, realizations_needed(run, prediction, result));
}

}  // namespace platoon
