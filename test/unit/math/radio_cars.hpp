#pragma once

#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/model/platoon_model.hpp"

namespace platoon {

/// Cooperative adaptive cruise control with a headway filter.
inline PlatoonModel radio_platoon_of(LoopDesign design, double headway, double radar, double radio,
                                     std::int64_t radio_delay, double period) {
  design.headway_filter = true;
  design.sends_input = true;
  VehicleModel vehicle(close_loop(design, headway), headway);
  vehicle.design = design;
  vehicle.position().noise_variance = radar;
  vehicle.inputs.push_back({InputSignal::input, radio});
  vehicle.radio()->link.delay = radio_delay;
  return {vehicle, LeaderProfile({{0, 20.0}}, period), period};
}

/// Cooperative adaptive cruise control (config/cacc.yaml) with a headway in seconds and this radio; noise of the radar
/// [m^2] and of the radio [(m/s^2)^2].
inline PlatoonModel radio_platoon(double headway_seconds, double radar, double radio, std::int64_t radio_delay = 2,
                                  double input_delay = 0.2) {
  constexpr double kPeriod = 0.01;
  return radio_platoon_of(
      {{car_with_actuator_lag(0.1, input_delay), kPeriod}, {ControllerGains{0.2, 0.7, 0.0}, kPeriod}},
      headway_seconds / kPeriod, radar, radio, radio_delay, kPeriod);
}

/// The radio loses inputs.
inline void lose_inputs(PlatoonModel& model, double probability, std::vector<double> predictor) {
  for (VehicleType& type : model.types) {
    if (type.vehicle.radio()) type.vehicle.radio()->link.loss = LossModel{probability, {}, predictor};
  }
}

/// Adds a type without a radio, every third follower.
inline void add_human_drivers(PlatoonModel& model) {
  VehicleType human{"human", model.default_vehicle(), {}};
  human.vehicle.inputs.resize(1);
  human.vehicle.headway = 350.0;
  human.vehicle.loop = close_loop(*human.vehicle.design, human.vehicle.headway);
  model.types.push_back(human);
  model.string = {0, 0, 1};
}

/// Adds trucks with a radio and without one, whose plants differ from the default one. A lag of 0 gives the sampled
/// plant a zero at z = -1.
inline void add_trucks(PlatoonModel& model, double lag, double input_delay, double gain = 1.0) {
  const double period = model.sample_period;
  LoopDesign design{{car_with_actuator_lag(lag, input_delay), period}, {ControllerGains{0.3, 0.8, 0.0}, period}};
  design.headway_filter = true;
  design.sends_input = true;
  VehicleType truck{"truck", model.default_vehicle(), {}};
  truck.vehicle.design = design;
  truck.vehicle.headway = 120.0;
  truck.vehicle.loop = close_loop(design, truck.vehicle.headway);
  truck.vehicle.radio()->gain = gain;
  VehicleType old_truck = truck;
  old_truck.name = "old_truck";
  old_truck.vehicle.inputs.resize(1);
  old_truck.vehicle.headway = 350.0;
  old_truck.vehicle.loop = close_loop(design, old_truck.vehicle.headway);
  model.types.push_back(truck);
  model.types.push_back(old_truck);
  model.string = {0, 1, 1, 0, 2};
}

}  // namespace platoon
