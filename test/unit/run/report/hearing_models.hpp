#pragma once

#include <string>

#include "stochastic_platoon/run/configuration/model_file.hpp"

namespace platoon {

/// A model file without its leader, which drives steadily.
inline PlatoonModel hearing_model(const std::string& text) {
  return parse_model(YAML::Load(text + "\nleader: {speed: [{from_step: 0, value: 20.0}]}\n"
                                       "initial_position: {mean: 0.0, variance: 0.0}\n"));
}

const char* const kPath = R"(
sample_period: 0.1
spacing: constant
standstill_distance: 5.0
plant: {actuator_lag: 0.5}
controller: {kp: 0.04, kd: 0.0}
inputs:
  - {signal: position, noise_variance: 0.05}
  - {signal: acceleration, gain: 0.5, noise_variance: 0.01}
  - {signal: acceleration, from: leader, gain: 0.5, noise_variance: 0.02}
  - {signal: speed, gain: 0.3, noise_variance: 0.03}
  - {signal: speed, from: leader, gain: 0.1, noise_variance: 0.04})";

const char* const kTwoAhead = R"(
sample_period: 0.1
time_headway: 8
standstill_distance: 2.0
plant: {actuator_lag: 0.3}
controller: {kp: 0.35, kd: 0.8}
inputs:
  - {signal: position, from: predecessor, weight: 0.6, noise_variance: 0.02}
  - {signal: position, from: 2, weight: 0.4, noise_variance: 0.05})";

const char* const kLeaderShare = R"(
sample_period: 0.05
spacing: constant
standstill_distance: 5.0
plant: {actuator_lag: 0.2}
controller: {kp: 0.5, kd: 1.1}
inputs:
  - {signal: position, weight: 0.7, noise_variance: 0.02}
  - {signal: position, from: leader, weight: 0.3, noise_variance: 0.04}
  - {signal: input, gain: 0.4, noise_variance: 0.01, channel: {delay: 1}})";

// Up to its radar.
const std::string kRadioCar = R"(
sample_period: 0.1
time_headway: 6
standstill_distance: 2.0
plant: {actuator_lag: 0.3}
controller: {kp: 0.5, kd: 1.2, headway_filter: true}
inputs:
  - {signal: position, noise_variance: 0.01})";

/// A car that hears control input and speed of its predecessor in one packet, lost together.
inline std::string packet(const std::string& loss) {
  return kRadioCar + R"(
  - {signal: input, gain: 1.0, noise_variance: 0.04, channel: {delay: 1, packet: radio, loss: )" +
         loss + R"(}}
  - {signal: speed, gain: 0.3, noise_variance: 0.03, channel: {packet: radio}})";
}

}  // namespace platoon
