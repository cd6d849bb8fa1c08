#include "stochastic_platoon/math/string/contradictions.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/math/statistics/ensemble_totals.hpp"
#include "stochastic_platoon/math/string/settling_time.hpp"

namespace platoon {

namespace {

constexpr double kSettled = 1e-4, kRounding = 1e-5;  // relative

bool differ(double one, double other, double share) {
  return std::abs(one - other) > share * std::max(std::abs(one), std::abs(other));
}

std::optional<std::string> between_table_and_stationary_value(const PlatoonModel& model, const TheoryFigures& of) {
  if (of.variance.empty()) return std::nullopt;
  const std::size_t settled = settled_followers(model, of.stationary_variance.size(), of.steps);
  for (std::size_t i = 1; i <= settled; ++i) {
    const double last = of.variance[cell(i, of.steps - 1, of.steps)], stationary = of.stationary_variance[i - 1];
    if (!std::isfinite(last) || !std::isfinite(stationary) || !differ(last, stationary, kSettled)) continue;
    return formatted("the variance of follower %zu at step %lld is %.6g m^2, but the stationary variance is %.6g m^2",
                     i, static_cast<long long>(of.steps - 1), last, stationary);
  }
  return std::nullopt;
}

std::optional<std::string> along_the_string(const std::vector<double>& stationary, std::size_t pattern) {
  for (std::size_t i = pattern; i < stationary.size(); ++i) {
    const double ahead = stationary[i - pattern], behind = stationary[i];
    if (!(behind < ahead && differ(ahead, behind, kRounding))) continue;
    return formatted(
        "the stationary variance falls along the string, from %.6g m^2 of follower %zu to %.6g m^2 of follower %zu",
        ahead, i - pattern + 1, behind, i + 1);
  }
  return std::nullopt;
}

std::optional<std::string> beside_limit(const StringStability& stability, const std::vector<double>& stationary) {
  if (!stability.limit_variance || stationary.empty()) return std::nullopt;
  const double limit = *stability.limit_variance;
  const auto largest = std::max_element(stationary.begin(), stationary.end());
  if (!(*largest > limit && differ(*largest, limit, kRounding))) return std::nullopt;
  return formatted(
      "the stationary variance of follower %zu is %.6g m^2, but the platoon is judged string stable with a limit of %.6g m^2",
      static_cast<std::size_t>(largest - stationary.begin()) + 1, *largest, limit);
}

}  // namespace

std::size_t settled_followers(const PlatoonModel& model, std::size_t followers, std::int64_t steps) {
  const bool lossy = loses(model);
  if (lossy && !model.recorded_leader.empty()) return 0;
  const std::int64_t changed = lossy && !model.leader.changes().empty() ? model.leader.changes().back().from_step : 0;
  const SettlingTime time(model);
  std::size_t settled = 0, other = followers + 1;
  while (other - settled > 1) {
    const std::size_t middle = settled + (other - settled) / 2;
    const std::optional<std::int64_t> settling = time.steps(middle);
    (settling && steps - changed > 2 * *settling ? settled : other) = middle;
  }
  return settled;
}

std::vector<std::string> contradictions(const PlatoonModel& model, const TheoryFigures& figures) {
  const bool plain = hears_predecessors_only(model);  // else variances may fall along the string
  std::vector<std::string> found;
  for (const std::optional<std::string>& contradiction :
       {between_table_and_stationary_value(model, figures),
        plain ? along_the_string(figures.stationary_variance, type_order(model).size()) : std::nullopt,
        plain ? beside_limit(figures.stability, figures.stationary_variance) : std::nullopt}) {
    if (contradiction) found.push_back(*contradiction);
  }
  return found;
}

}  // namespace platoon
