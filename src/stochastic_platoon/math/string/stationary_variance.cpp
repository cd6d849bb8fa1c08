#include "stochastic_platoon/math/string/stationary_variance.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <utility>

#include "stochastic_platoon/math/numerics/special_values.hpp"
#include "stochastic_platoon/math/string/settled_hearing.hpp"

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

std::vector<double> stationary_variances(const StringTheory& theory, std::size_t followers) try {
  require_followers(followers);
  if (!theory.mean_square_stable()) return std::vector<double>(followers, kNaN);
  return theory.settled(followers, [followers](StringWalk& walk) {
    std::vector<double> variances;
    while (variances.size() < followers && (variances.empty() || !std::isinf(variances.back()))) {
      walk.pass(sum_of(walk.added()));
      const double variance = walk.error_variance();
      variances.push_back(std::isnan(variance) ? kInfinity : variance);
    }
    variances.resize(followers, kInfinity);
    return variances;
  });
} catch (const NarrowSpectra&) {
  return std::vector<double>(followers, kNaN);
}

std::vector<std::vector<double>> stationary_variances_by_input(const StringTheory& theory, std::size_t followers) {
  require_followers(followers);
  std::size_t inputs = hears_predecessors_only(theory.model()) ? 2 : 0;  // the position and the predecessor's input
  for (const VehicleModel& of : pattern(theory.model())) inputs = std::max(inputs, of.inputs.size());
  std::vector<std::vector<double>> shares(followers, std::vector<double>(inputs, kNaN));
  if (!theory.mean_square_stable()) return shares;
  const auto along = [followers, inputs](StringWalk& walk) {
    std::vector<std::unique_ptr<StringWalk>> of_input;
    for (std::size_t n = 0; n < inputs; ++n) of_input.push_back(walk.clone());
    std::vector<double> variances;
    for (std::size_t i = 0; i < followers; ++i) {
      std::vector<Eigen::ArrayXd> added = walk.added();
      walk.pass(sum_of(added));
      added.resize(inputs, Eigen::ArrayXd::Zero(added.front().size()));
      for (std::size_t n = 0; n < inputs; ++n) {
        of_input[n]->pass(std::move(added[n]));
        variances.push_back(of_input[n]->error_variance());
      }
    }
    return variances;
  };
  try {
    const std::vector<double> values = theory.settled(followers, along);
    for (std::size_t i = 0; i < followers; ++i)
      std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(i * inputs), inputs, shares[i].begin());
  } catch (const NarrowSpectra&) {
    // They stay NaN.
  }
  return shares;
}

}  // namespace platoon
