#include "stochastic_platoon/math/string/stationary_variance.hpp"

#include <array>

#include "stochastic_platoon/math/links/linked_string.hpp"
#include "stochastic_platoon/math/numerics/special_values.hpp"
#include "stochastic_platoon/math/string/hearing_signals.hpp"
#include "stochastic_platoon/math/string/hearing_string.hpp"

namespace platoon {

namespace {

void require_followers(std::size_t followers) {
  if (followers < 1) throw std::invalid_argument("followers: 0: must be >= 1");
}

}  // namespace

double metres_per_step(const PlatoonModel& model) {
  if (!model.recorded_leader.empty()) {
    const std::size_t n = model.recorded_leader.size();
    return n < 2 ? 0.0 : model.recorded_leader[n - 1] - model.recorded_leader[n - 2];
  }
  return model.leader.changes().empty() ? 0.0 : model.sample_period * model.leader.changes().back().value;
}

std::vector<double> stationary_variances(const PlatoonModel& model, std::size_t followers) {
  require_followers(followers);
  if (!hears_predecessors_only(model)) return hearing_variances(model, followers);
  const LinkedPattern pattern(model);
  if (!pattern.mean_square_stable()) return std::vector<double>(followers, kNaN);
  return stationary_variances(pattern, metres_per_step(model), followers);
}

std::vector<std::vector<double>> stationary_variances_by_input(const PlatoonModel& model, std::size_t followers) {
  require_followers(followers);
  if (!hears_predecessors_only(model)) return hearing_variances_by_input(model, followers);
  const LinkedPattern pattern(model);
  if (!pattern.mean_square_stable()) return {followers, {kNaN, kNaN}};
  std::vector<std::vector<double>> shares;
  for (const std::array<double, 2>& of : variances_by_input(pattern, metres_per_step(model), followers))
    shares.emplace_back(of.begin(), of.end());
  return shares;
}

std::vector<double> stationary_means(const PlatoonModel& model, std::size_t followers) {
  require_followers(followers);
  if (!hears_predecessors_only(model)) return hearing_means(model, followers);
  const LinkedPattern pattern(model);
  std::vector<double> means(followers, kNaN);
  if (!pattern.mean_square_stable()) return means;
  for (std::size_t i = 0; i < followers; ++i) means[i] = metres_per_step(model) * pattern[i].lag();
  return means;
}

}  // namespace platoon
