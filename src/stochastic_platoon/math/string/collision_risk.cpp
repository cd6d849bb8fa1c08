#include "stochastic_platoon/math/string/collision_risk.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "stochastic_platoon/math/numerics/interruption.hpp"
#include "stochastic_platoon/math/numerics/special_values.hpp"
#include "stochastic_platoon/math/statistics/normal_crossing.hpp"

namespace platoon {

namespace {

/// Upper bound of P(g(k) < 0 for some k) for the follower with this first cell.
double bound_over(const SignalMoments& table, std::size_t first, std::size_t steps) {
  const auto law = [&table](std::size_t cell) { return NormalLaw{table.mean[cell], table.variance[cell]}; };
  double sum = probability_below_zero(law(first));
  for (std::size_t cell = first + 1; cell < first + steps && sum < 1.0; ++cell) {
    check_interruption();
    const double change = table.variance[cell - 1] + table.variance[cell] - 2.0 * table.covariance_with_previous[cell];
    sum += probability_of_crossing(law(cell - 1), law(cell), change);
  }
  return sum < 1.0 ? sum : 1.0;  // also where moments beyond the range of double leave NaN
}

struct StationaryRisk {
  std::vector<double> probability, rate, required_distance;
};

/// `gaps`: of followers 1, 2, ..., or of the places of the pattern in an endless string.
StationaryRisk stationary_risk(const PlatoonModel& model, const StationaryMoments& gaps, double probability) {
  // Where unlike vehicles hear others, a mean error depends on the distances of several.
  const bool moves_alone = hears_predecessors_only(model) || is_homogeneous(model);
  StationaryRisk risk;
  for (std::size_t j = 0; j < gaps.mean.size(); ++j) {
    const NormalLaw gap{gaps.mean[j], gaps.variance[j]};
    risk.probability.push_back(probability_below_zero(gap));
    risk.rate.push_back(probability_of_crossing(gap, gap, gaps.change[j]));
    const double missing = mean_needed(gap.variance, probability) - gap.mean;
    const double distance = moves_alone ? vehicle(model, j + 1).standstill_distance + missing : kNaN;
    risk.required_distance.push_back(distance < 0.0 ? 0.0 : distance);
  }
  return risk;
}

double largest(const std::vector<double>& values) {
  return *std::max_element(values.begin(), values.end());
}

}  // namespace

std::vector<double> collision_bounds(const SignalMoments& gaps, std::size_t steps) {
  if (gaps.covariance_with_previous.size() != gaps.mean.size())
    throw std::invalid_argument("moments: without covariances: must be those of normal gaps");
  std::vector<double> bounds;
  for (std::size_t first = 0; first < gaps.mean.size(); first += steps)
    bounds.push_back(bound_over(gaps, first, steps));
  return bounds;
}

CollisionRisk collision_risk(const PlatoonModel& model, const StationarySignal& gap, const SignalMoments& table,
                             std::size_t steps, double probability) {
  require_normal_errors(model);
  StationaryRisk of_followers = stationary_risk(model, gap.followers, probability);
  CollisionRisk risk{std::move(of_followers.probability),
                     std::move(of_followers.rate),
                     collision_bounds(table, steps),
                     std::move(of_followers.required_distance),
                     0.0,
                     {},
                     {},
                     {}};
  const double share = probability / static_cast<double>(gap.followers.mean.size());
  risk.platoon_required_distance = largest(stationary_risk(model, gap.followers, share).required_distance);
  if (!gap.limit) return risk;
  const StationaryRisk endless = stationary_risk(model, *gap.limit, probability);
  risk.limit_probability = largest(endless.probability);
  risk.limit_rate = largest(endless.rate);
  risk.limit_required_distance = largest(endless.required_distance);
  return risk;
}

}  // namespace platoon
