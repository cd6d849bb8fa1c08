#include "stochastic_platoon/math/string/mean_vehicle.hpp"

#include <stdexcept>

namespace platoon {

MeanVehicle::MeanVehicle(const VehicleModel& vehicle)
    : loop_(vehicle.loop),
      headway_(vehicle.headway),
      delay_(static_cast<std::size_t>(vehicle.link.delay)),
      loss_(vehicle.link.loss.value_or(LossModel())) {
  if (!loss_.is_independent()) throw std::invalid_argument("mean_burst: given: must be absent for this theory");
}

MeanVehicle::Passed MeanVehicle::operator()(const Sequence& predecessor) const {
  Passed passed;
  Sequence received{predecessor.front()};
  for (std::size_t a = 1; a < predecessor.size(); ++a) {
    const long double arriving = predecessor[a > delay_ ? a - delay_ : 0];
    const long double predicted = prediction(received);
    passed.innovation.push_back(arriving - predicted);
    received.push_back(predicted + (1.0L - probability()) * passed.innovation.back());
  }
  passed.position = loop_(received);
  return passed;
}

MeanVehicle::Passed MeanVehicle::of_loss(std::size_t steps) const {
  Passed passed;
  Sequence received{0.0L};
  for (std::size_t k = 0; k < steps; ++k) {
    const long double predicted = prediction(received);
    passed.innovation.push_back(-predicted);
    received.push_back(probability() * predicted + (k == 0 ? 1.0L : 0.0L));
  }
  passed.position = loop_(received);
  return passed;
}

MeanVehicle::Sequence MeanVehicle::error(const Sequence& predecessor, const Sequence& own) const {
  Sequence errors;
  for (std::size_t a = 1; a < own.size(); ++a)
    errors.push_back(predecessor[a] - own[a] - headway_ * (own[a] - own[a - 1]));
  return errors;
}

// c_1 r(k-1) + c_2 r(k-2) + ...
long double MeanVehicle::prediction(const Sequence& received) const {
  long double sum = 0.0L;
  for (std::size_t j = 0; j < loss_.predictor.size(); ++j)
    sum += loss_.predictor[j] * (received.size() > j ? received[received.size() - 1 - j] : received.front());
  return sum;
}

}  // namespace platoon
