#include "stochastic_platoon/math/links/linked_responses.hpp"

#include <stdexcept>
#include <string>
#include <utility>

#include "stochastic_platoon/math/model/formation.hpp"
#include "stochastic_platoon/math/numerics/interruption.hpp"

namespace platoon {

MeanVehicle::Sequence signal_values(const Signal& signal, const MeanVehicle::Sequence& predecessor,
                                    const Motion& motion) {
  if (signal.is_input) return motion.input;
  const MeanVehicle::Sequence& own = motion.position;
  MeanVehicle::Sequence values(own.size(), 0.0L);
  check_interruption();
  if (signal.order > 0) {
    values = own;
    for (int n = 0; n < signal.order; ++n) {
      for (std::size_t a = values.size(); --a > 0;) values[a] -= values[a - 1];
      values[0] = 0.0L;
    }
    for (long double& value : values) value *= static_cast<long double>(signal.factor);
  }
  if (signal.relative) {
    for (std::size_t a = 0; a < values.size(); ++a) values[a] += predecessor[a] - own[a];
  }
  return values;
}

ResponseProducts::ResponseProducts(const MeanVehicle::Sequence& response, bool is_noise) {
  check_interruption();
  for (std::size_t a = 1; a < response.size(); ++a) {
    variance.push_back(response[a] * response[a]);
    covariance.push_back(response[a - 1] * response[a]);
  }
  if (!is_noise) return;
  for (MeanVehicle::Sequence* sums : {&variance, &covariance}) {
    for (std::size_t k = 1; k < sums->size(); ++k) (*sums)[k] += (*sums)[k - 1];
  }
}

void ResponseProducts::add(const ResponseProducts& other) {
  for (std::size_t k = 0; k < variance.size(); ++k) variance[k] += other.variance[k];
  for (std::size_t k = 0; k < covariance.size(); ++k) covariance[k] += other.covariance[k];
}

CausalConvolution::Values squares(const MeanVehicle::Sequence& values) {
  CausalConvolution::Values result;
  for (const long double value : values) result.push_back(static_cast<double>(value * value));
  return result;
}

MeanVehicle::Sequence virtual_leader(const PlatoonModel& model, std::size_t steps) {
  MeanVehicle::Sequence positions{0.0L};
  for (std::int64_t k = -1; positions.size() <= steps; ++k)
    positions.push_back(positions.back() + static_cast<long double>(model.sample_period * model.leader.speed(k)));
  return positions;
}

namespace {

// As LeaderVehicle::input().
MeanVehicle::Sequence accelerations(const MeanVehicle::Sequence& positions, long double slope, long double period) {
  MeanVehicle::Sequence inputs{0.0L};
  for (std::size_t k = 1; k < positions.size(); ++k) {
    const long double moved = positions[k] - positions[k - 1];
    inputs.push_back((moved - slope) / (period * period));
    slope = moved;
  }
  return inputs;
}

}  // namespace

Motion leader_motion(const PlatoonModel& model, std::size_t steps) {
  Motion received;
  MeanVehicle::Sequence& positions = received.position;
  if (moves_leader(model)) {
    if (model.recorded_leader.empty()) {
      positions = virtual_leader(model, steps);
    } else if (model.recorded_leader.size() < steps + 1) {
      throw std::invalid_argument("recorded leader: " + std::to_string(model.recorded_leader.size()) +
                                  " positions: must be at least steps + 1 = " + std::to_string(steps + 1));
    } else {
      positions.assign(model.recorded_leader.begin(),
                       model.recorded_leader.begin() + static_cast<std::ptrdiff_t>(steps + 1));
    }
    if (has_radios(model)) received.input = accelerations(positions, start_slope(model), model.sample_period);
    return received;
  }
  positions = virtual_leader(model, steps);
  return VehicleResponse(model.default_vehicle())(received);
}

MeanVehicle::Sequence filtered_impulse(const TransferFunction& filter, std::size_t steps) {
  const Polynomial &b = filter.numerator(), &a = filter.denominator();
  const Eigen::Index lead = a.size() - b.size();
  MeanVehicle::Sequence w(steps + 1, 0.0L);
  for (std::size_t k = 0; k < steps; ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    long double value = at >= lead && at - lead < b.size() ? b(at - lead) : 0.0;
    for (Eigen::Index j = 1; j < a.size() && j <= at; ++j) value -= a(j) * w[k + 1 - static_cast<std::size_t>(j)];
    w[k + 1] = value;
  }
  return w;
}

LinkedResponses::LinkedResponses(const PlatoonModel& model, std::size_t followers, std::size_t steps)
    : model_(model), followers_(followers), steps_(steps), vehicles_(pattern(model)) {
  if (has_limits(model)) throw std::invalid_argument("no theory, as vehicles have limits");
  for (const VehicleModel& vehicle : vehicles_) mean_vehicles_.emplace_back(vehicle);
}

void LinkedResponses::visit_means(const Visitor& visit) const {
  Motion predecessor = leader_motion(model_, steps_);
  for (std::size_t i = 0; i < followers_; ++i) {
    MeanVehicle::Passed passed = vehicle(i)(predecessor);
    const long double placed = model(i).initial_position.mean;
    if (placed != 0.0L) {
      const Motion free = vehicle(i).free_motion(steps_);
      for (std::size_t a = 0; a < free.position.size(); ++a) passed.own.position[a] += placed * free.position[a];
      for (std::size_t a = 0; a < free.input.size(); ++a) passed.own.input[a] += placed * free.input[a];
    }
    visit(i, predecessor.position, passed);
    predecessor = std::move(passed.own);
  }
}

LinkedResponses::Means LinkedResponses::means() const {
  Means result;
  visit_means([&](std::size_t i, const Sequence& predecessor, const MeanVehicle::Passed& passed) {
    const Sequence errors = vehicle(i).error(predecessor, passed.own.position);
    result.error.insert(result.error.end(), errors.begin(), errors.end());
    result.innovation.emplace_back();
    for (std::size_t link = 0; link < vehicle(i).links(); ++link) {
      if (vehicle(i).variance_factor(link) > 0.0)
        result.innovation.back()[link].assign(passed.innovation[link].begin(), passed.innovation[link].end());
    }
  });
  return result;
}

Responses LinkedResponses::downstream(std::size_t place, Motion motion) const {
  Responses responses;
  Motion predecessor{Sequence(steps_ + 1, 0.0L), {}};
  MeanVehicle::Passed passed{{}, std::move(motion)};
  for (std::size_t i = place; i < followers_; ++i) {
    if (i > place) {
      predecessor = std::move(passed.own);
      passed = vehicle(i)(predecessor);
    }
    responses.error.push_back(squares(vehicle(i).error(predecessor.position, passed.own.position)));
    for (std::size_t link = 0; link < passed.innovation.size(); ++link) {
      const bool loses = link < vehicle(i).links() && vehicle(i).variance_factor(link) > 0.0;
      responses.innovation[link].push_back(loses ? squares(passed.innovation[link]) : Values());
    }
  }
  return responses;
}

LinkedResponses::Sequence LinkedResponses::impulse() const {
  Sequence sequence(steps_ + 1, 0.0L);
  sequence[1] = 1.0L;
  return sequence;
}

}  // namespace platoon
