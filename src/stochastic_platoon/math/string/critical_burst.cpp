#include "stochastic_platoon/math/string/critical_burst.hpp"

#include <algorithm>
#include <cmath>

#include "stochastic_platoon/math/links/linked_pattern.hpp"
#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/string/varied_margins.hpp"

namespace platoon {

namespace {

constexpr double kLongest = 200.0, kRatio = 1.5;
constexpr double kBesideAlternation = 1.001;  // a chain of q = 1/2 with mean burst 1 has no theory

double least_burst(const PlatoonModel& model) {
  double least = 1.0;
  for (const VehicleType& type : model.types) {
    const LinkModel& link = type.vehicle.varied_link();
    if (!type.inherited.mean_burst || !link.loses()) continue;
    LossModel loss = *link.loss;
    loss.mean_burst = loss.least_burst();
    least = std::max(least, loss.alternates() ? kBesideAlternation : *loss.mean_burst);
  }
  return least;
}

}  // namespace

std::optional<CriticalBurst> critical_mean_burst(const PlatoonModel& model) {
  if (const auto reason = no_theory(model)) throw std::invalid_argument("no theory, as " + *reason);
  const std::vector<std::string> types = types_with_default(model, &Inherited::mean_burst);
  const LinkModel& own = model.default_vehicle().varied_link();
  if (!own.loses() || own.loss->markov || types.empty()) return std::nullopt;
  const double least = least_burst(model);
  CriticalBurst found{least, std::max(kLongest, 2.0 * least), {}, true, types};
  const VariedMargins margins = varied_margins([&model](double burst) { return with_mean_burst(model, burst); }, least);
  const auto is_stable = [&](double burst) { return margins.gain(burst) > 0.0 && margins.losses(burst) > 0.0; };
  found.stable = is_stable(least);
  if (!found.stable) return found;
  const double steps = std::ceil(std::log(found.to / least) / std::log(kRatio));
  double before = least;
  for (int step = 1; step <= steps; ++step) {
    const double burst = least * std::pow(found.to / least, step / steps);
    if (!is_stable(burst)) {
      found.critical = margins.intervals({before, burst}).front().to;
      break;
    }
    before = burst;
  }
  return found;
}

}  // namespace platoon
