#include "stochastic_platoon/math/string/contradictions.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/math/statistics/ensemble_totals.hpp"
#include "stochastic_platoon/math/string/settling_time.hpp"

namespace platoon {

namespace {

constexpr double kSettled = 1e-4, kRounding = 1e-5;  // relative
constexpr double kDecayed = 1e-12;  // what is left of the start, or of a variance that only the start has

bool differ(double one, double other, double share) {
  return std::abs(one - other) > share * std::max(std::abs(one), std::abs(other));
}

// "variance of the gap of follower 3".
std::string variance_of(const TheoryFigures& of, std::size_t follower) {
  return "variance of " + (of.signal.empty() ? "" : "the " + in_words(of.signal) + " of ") +
         formatted("follower %zu", follower);
}

// "0.25 (m/s)^2".
std::string value_of(const TheoryFigures& of, double variance) {
  return formatted(of.signal.empty() ? "%.6g m^2" : "%.6g (%s)^2", variance,
                   of.signal.empty() ? "" : unit_of(of.signal));
}

std::optional<std::string> between_table_and_stationary_value(const TheoryFigures& of, std::size_t settled,
                                                              std::int64_t steps) {
  if (of.variance.empty()) return std::nullopt;
  for (std::size_t i = 1; i <= settled; ++i) {
    const double last = of.variance[cell(i, steps - 1, steps)], stationary = of.stationary_variance[i - 1];
    if (!std::isfinite(last) || !std::isfinite(stationary) || !differ(last, stationary, kSettled)) continue;
    const auto row = of.variance.begin() + static_cast<std::ptrdiff_t>(cell(i, 0, steps));
    if (std::abs(last - stationary) <= kDecayed * *std::max_element(row, row + steps)) continue;
    return formatted("the %s at step %lld is %s, but the stationary variance is %s", variance_of(of, i).c_str(),
                     static_cast<long long>(steps - 1), value_of(of, last).c_str(), value_of(of, stationary).c_str());
  }
  return std::nullopt;
}

std::optional<std::string> along_the_string(const TheoryFigures& of, std::size_t pattern) {
  for (std::size_t i = pattern; i < of.stationary_variance.size(); ++i) {
    const double ahead = of.stationary_variance[i - pattern], behind = of.stationary_variance[i];
    if (!(behind < ahead && differ(ahead, behind, kRounding))) continue;
    return formatted("the stationary variance falls along the string: the %s is %s, that of follower %zu %s",
                     variance_of(of, i - pattern + 1).c_str(), value_of(of, ahead).c_str(), i + 1,
                     value_of(of, behind).c_str());
  }
  return std::nullopt;
}

std::optional<std::string> beside_limit(const TheoryFigures& of) {
  if (!of.limit_variance || of.stationary_variance.empty()) return std::nullopt;
  const double limit = *of.limit_variance;
  const auto largest = std::max_element(of.stationary_variance.begin(), of.stationary_variance.end());
  if (!(*largest > limit && differ(*largest, limit, kRounding))) return std::nullopt;
  return formatted("the stationary %s is %s, but the platoon is judged string stable with a limit of %s",
                   variance_of(of, static_cast<std::size_t>(largest - of.stationary_variance.begin()) + 1).c_str(),
                   value_of(of, *largest).c_str(), value_of(of, limit).c_str());
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

std::vector<std::string> contradictions(const PlatoonModel& model, const std::vector<TheoryFigures>& figures,
                                        std::int64_t steps) {
  const bool plain = hears_predecessors_only(model);  // else variances may fall along the string
  const std::size_t followers = figures.front().stationary_variance.size();
  const std::size_t settled = settled_followers(model, followers, steps);
  std::vector<std::string> found;
  for (const TheoryFigures& of : figures) {
    for (const std::optional<std::string>& contradiction :
         {between_table_and_stationary_value(of, settled, steps),
          plain ? along_the_string(of, type_order(model).size()) : std::nullopt,
          plain ? beside_limit(of) : std::nullopt}) {
      if (contradiction) found.push_back(*contradiction);
    }
  }
  return found;
}

}  // namespace platoon
