#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "stochastic_platoon/math/model/link_model.hpp"

namespace platoon {

/// What an input of a follower carries: the position y of its source, the differences D y / T_s and D^2 y / T_s^2, or
/// the control input u.
enum class InputSignal { position, speed, acceleration, input };

/// What a follower i receives from a vehicle ahead, over a link of its own. With s(j) the source of input j, d_j = i -
/// s(j), r_j the received value, D y(k) = y(k) - y(k-1), and H = (1 + h) - h / z if the vehicle has a headway filter, 1
/// otherwise,
/// \f[ H u_i = K \sum_{positions} w_j (r_j - y_i - d_j h D y_i - d_j \delta) + \sum_{speeds} F_j (r_j - D y_i / T_s)
///           + \sum_{accelerations, inputs} F_j r_j + F_a D^2 y_i / T_s^2, \qquad y_i = G u_i, \f]
/// where the weights w_j sum to 1 and F_a is VehicleModel::own_acceleration. The input of step k is known one step
/// after the position of step k, so its delay is m >= 1: v(k) = u(k-1) is sent with the position of step k, and the
/// link delays it by m - 1 steps.
struct Input {
  InputSignal signal = InputSignal::position;
  double noise_variance = 0.0;  ///< >= 0, P_d of positions [m^2], else in the squared unit of the signal
  double gain = 1.0;            ///< w or F
  LinkModel link = {};          ///< its delay is m
  std::size_t ahead = 1;        ///< the source is this many vehicles ahead, at most vehicle 0; kLeader: vehicle 0
  std::string packet = {};      ///< inputs of a vehicle with the same name are lost together; empty: alone

  static constexpr std::size_t kLeader = 0;

  /// Steps between sending and arrival.
  std::int64_t delay() const { return signal == InputSignal::input ? link.delay - 1 : link.delay; }
};

bool operator==(const Input& one, const Input& other);

/// As in model files: "position", "speed", "acceleration", "input".
const char* name_of(InputSignal signal);

/// Whether an input carries differences of positions, which the sender of the positions need not form.
inline bool is_difference(InputSignal signal) {
  return signal == InputSignal::speed || signal == InputSignal::acceleration;
}

/// The vehicle that an input of a follower comes from.
std::size_t source_of(const Input& input, std::size_t follower);

/// The first of the inputs in the packet of input n, whose losses the others share; n itself without a packet.
template <typename Of>
std::size_t first_of_packet(const std::vector<Of>& inputs, std::size_t n) {
  for (std::size_t j = 0; j < n && !inputs[n].packet.empty(); ++j) {
    if (inputs[j].packet == inputs[n].packet) return j;
  }
  return n;
}

/// What decides whose losses are varied, of an input.
struct LossPlace {
  bool is_position = true;
  bool loses = false;
  std::string packet = {};
};

/// The input whose losses the setting `loss` and the critical values vary, with all of its packet: of the inputs other
/// than positions (of positions, if there are no others) the last that loses, or the last if none loses. Of a packet
/// its first input.
std::size_t varied_losses(const std::vector<LossPlace>& inputs);

}  // namespace platoon
