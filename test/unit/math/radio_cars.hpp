#pragma once

#include "stochastic_platoon/math/model/platoon_model.hpp"

namespace platoon {

/// Cooperative adaptive cruise control (config/cacc.yaml) with a headway in seconds and this radio; noise of the radar
/// [m^2] and of the radio [(m/s^2)^2].
inline PlatoonModel radio_platoon(double headway_seconds, double radar, double radio, std::int64_t radio_delay = 2,
                                  double input_delay = 0.2) {
  constexpr double kPeriod = 0.01;
  LoopDesign design{{car_with_actuator_lag(0.1, input_delay), kPeriod}, {ControllerGains{0.2, 0.7, 0.0}, kPeriod}};
  design.headway_filter = true;
  design.in_radio_string = true;
  const double headway = headway_seconds / kPeriod;
  VehicleModel vehicle{close_loop(design, headway), headway};
  vehicle.design = design;
  vehicle.noise_variance = radar;
  vehicle.feed_forward = FeedForward{1.0, radio, {}};
  vehicle.feed_forward->link.delay = radio_delay;
  return {vehicle, LeaderProfile({{0, 20.0}}, kPeriod), kPeriod};
}

/// The radio loses inputs.
inline void lose_inputs(PlatoonModel& model, double probability, std::vector<double> predictor) {
  for (VehicleType& type : model.types) {
    if (type.vehicle.feed_forward) type.vehicle.feed_forward->link.loss = LossModel{probability, {}, predictor};
  }
}

/// Adds a type without a radio, every third follower.
inline void add_human_drivers(PlatoonModel& model) {
  VehicleType human{"human", model.default_vehicle(), {}};
  human.vehicle.feed_forward.reset();
  human.vehicle.headway = 350.0;
  human.vehicle.loop = close_loop(*human.vehicle.design, human.vehicle.headway);
  model.types.push_back(human);
  model.string = {0, 0, 1};
}

}  // namespace platoon
