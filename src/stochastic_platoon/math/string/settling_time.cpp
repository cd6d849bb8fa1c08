#include "stochastic_platoon/math/string/settling_time.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "stochastic_platoon/math/model/hearing_loop.hpp"
#include "stochastic_platoon/math/model/loss_chain.hpp"
#include "stochastic_platoon/math/numerics/delta_form.hpp"

namespace platoon {

namespace {

/// A bound of the decay of the predictions, and the memory of the chain.
double loss_radius(const LossModel& loss) {
  return std::max(std::sqrt(second_moment_radius(loss)), LossChain(loss).memory());
}

double slowest_radius(const VehicleModel& vehicle, double own) {
  double radius = own;
  for (const Input& input : vehicle.inputs) {
    const LinkModel& link = input.link;
    if (link.loses()) radius = std::max(radius, loss_radius(*link.loss));
    if (!link.has_white_noise())
      radius = std::max(radius, spectral_radius(delta_form(link.noise_filter.denominator())));
  }
  return radius;
}

}  // namespace

SettlingTime::SettlingTime(const PlatoonModel& model) : vehicles_(pattern(model)) {
  if (!moves_leader(model)) radius_ = spectral_radius(model.default_vehicle().loop);  // the leader's
  const bool plain = hears_predecessors_only(model);
  for (std::size_t i = 1; i <= vehicles_.size() + (plain ? 0 : farthest_ahead(model)); ++i) {
    const VehicleModel& own = vehicles_[(i - 1) % vehicles_.size()];
    radius_ =
        std::max(radius_, slowest_radius(own, plain ? spectral_radius(own.loop)
                                                    : HearingLoop(own, i, model.sample_period).spectral_radius()));
  }
}

std::optional<std::int64_t> SettlingTime::steps(std::size_t followers) const {
  if (!(radius_ < 1.0)) return std::nullopt;
  double delays = 0.0;
  for (std::size_t i = 0; i < followers; ++i) {
    const VehicleModel& vehicle = vehicles_[i % vehicles_.size()];
    std::int64_t longest = 0;
    for (const Input& input : vehicle.inputs) longest = std::max(longest, input.link.delay);
    delays += static_cast<double>(vehicle.loop.realization.order()) + static_cast<double>(longest);
  }
  const double n = static_cast<double>(followers), l = -std::log(kRestOfStart);
  const double decay = radius_ > 0.0 ? (n + std::sqrt(2.0 * n * l) + l) / -std::log(radius_) : 0.0;
  return static_cast<std::int64_t>(std::ceil(delays + decay));
}

std::optional<std::int64_t> settling_steps(const PlatoonModel& model, std::size_t followers) {
  return SettlingTime(model).steps(followers);
}

}  // namespace platoon
