#include "stochastic_platoon/math/links/mean_vehicle.hpp"

#include <stdexcept>
#include <utility>

#include "stochastic_platoon/math/numerics/interruption.hpp"

namespace platoon {

MeanVehicle::MeanVehicle(const VehicleModel& vehicle) : vehicle_(vehicle), headway_(vehicle.headway) {
  for (const Input& input : vehicle.inputs) {
    links_.push_back({static_cast<std::size_t>(input.delay()), input.link.loss.value_or(LossModel())});
    if (!links_.back().loss.is_independent())
      throw std::invalid_argument("mean_burst: given: must be absent for this theory");
  }
}

MeanVehicle::Passed MeanVehicle::operator()(const Motion& predecessor) const {
  Passed passed;
  Motion received{links_[0].pass(predecessor.position, passed.innovation[0]), {}};
  if (links() > 1) received.input = links_[1].pass(predecessor.input, passed.innovation[1]);
  passed.own = vehicle_(received);
  return passed;
}

MeanVehicle::Passed MeanVehicle::over_link(std::size_t link, const Sequence& sent) const {
  Motion only = nothing(sent.size());
  (link == 0 ? only.position : only.input) = sent;
  return (*this)(only);
}

MeanVehicle::Passed MeanVehicle::of_loss(std::size_t link, std::size_t steps) const {
  check_interruption();
  Passed passed;
  Sequence received{0.0L};
  for (std::size_t k = 0; k < steps; ++k) {
    const long double predicted = links_[link].prediction(received);
    passed.innovation[link].push_back(-predicted);
    received.push_back(static_cast<long double>(links_[link].loss.probability) * predicted + (k == 0 ? 1.0L : 0.0L));
  }
  Motion only = nothing(received.size());
  (link == 0 ? only.position : only.input) = std::move(received);
  passed.own = vehicle_(only);
  return passed;
}

MeanVehicle::Sequence MeanVehicle::error(const Sequence& predecessor, const Sequence& own) const {
  check_interruption();
  Sequence errors;
  for (std::size_t a = 1; a < own.size(); ++a)
    errors.push_back(predecessor[a] - own[a] - headway_ * (own[a] - own[a - 1]));
  return errors;
}

double MeanVehicle::variance_factor(std::size_t link) const {
  const double q = links_[link].loss.probability;
  return q * (1.0 - q);
}

Motion MeanVehicle::nothing(std::size_t count) const {
  const Sequence zero(count, 0.0L);
  return {zero, links() > 1 ? zero : Sequence()};
}

// c_1 r(k-1) + c_2 r(k-2) + ...
long double MeanVehicle::MeanLink::prediction(const Sequence& received) const {
  long double sum = 0.0L;
  for (std::size_t j = 0; j < loss.predictor.size(); ++j)
    sum += loss.predictor[j] * (received.size() > j ? received[received.size() - 1 - j] : received.front());
  return sum;
}

MeanVehicle::Sequence MeanVehicle::MeanLink::pass(const Sequence& sent, Sequence& innovation) const {
  check_interruption();
  const long double arrival = 1.0L - static_cast<long double>(loss.probability);
  Sequence received{sent.front()};
  for (std::size_t a = 1; a < sent.size(); ++a) {
    const long double arriving = sent[a > delay ? a - delay : 0];
    const long double predicted = prediction(received);
    innovation.push_back(arriving - predicted);
    received.push_back(predicted + arrival * innovation.back());
  }
  return received;
}

}  // namespace platoon
