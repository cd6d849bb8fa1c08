#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/math/model/closed_loop.hpp"
#include "stochastic_platoon/math/model/link_model.hpp"
#include "stochastic_platoon/math/model/vehicle_limits.hpp"

namespace platoon {

/// Initial position of follower i: -i delta plus N(mean, variance), independent per follower and realization.
struct InitialPosition {
  double mean = 0.0;      ///< [m]
  double variance = 0.0;  ///< [m^2], >= 0
};

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

/// The vehicle that an input of a follower comes from.
std::size_t source_of(const Input& input, std::size_t follower);

/// Per-follower part of the model: the vehicle, its spacing and what it receives.
struct VehicleModel {
  ClosedLoop loop;
  double headway;                         ///< h > 0, in sample periods; 0 with constant_spacing
  double standstill_distance = 0.0;       ///< delta >= 0 [m], to its predecessor
  std::vector<Input> inputs = {Input()};  ///< the position, and with a radio the control input of the predecessor
  InitialPosition initial_position = {};
  std::optional<LoopDesign> design = {};  ///< none if the closed loop itself was given
  double length = 0.0;                    ///< >= 0 [m]; y is the position of the front
  VehicleLimits limits = {};              ///< of vehicles with a design only
  bool constant_spacing = false;          ///< h = 0
  double own_acceleration = 0.0;          ///< F_a, see Input

  /// Whether the vehicle hears its predecessor alone, as all formulas without Input::ahead assume: one position, behind
  /// it one control input or none, and a headway.
  bool hears_predecessor_only() const;

  /// The first position among the inputs.
  const Input& position() const;
  Input& position() { return const_cast<Input&>(const_cast<const VehicleModel*>(this)->position()); }
  const Input* radio() const { return inputs.size() > 1 ? &inputs.back() : nullptr; }  ///< null: none
  Input* radio() { return inputs.size() > 1 ? &inputs.back() : nullptr; }

  /// The input whose losses input n shares: the first of its packet, else itself.
  std::size_t losses_of(std::size_t n) const;

  /// The inputs whose losses with_loss() varies. They are lost together. A vehicle that hears its predecessor alone has
  /// one of them: the radio if there is one, else the position. Any other vehicle has the packet of its last input that
  /// loses, or of its last input if none loses.
  std::vector<std::size_t> varied_inputs() const;
  const LinkModel& varied_link() const { return inputs[varied_inputs().front()].link; }

  /// Calls change(link) with the link of each of them.
  template <class Change>
  void vary(const Change& change) {
    for (const std::size_t n : varied_inputs()) change(inputs[n].link);
  }
};

/// The sum of w_j d_j of a follower (see Input): its distance, in vehicles, that its headway and delta multiply. 1 if
/// it hears its predecessor alone.
double spacing_in_vehicles(const VehicleModel& vehicle, std::size_t follower);

/// The sum of F_j / T_s over the speeds that a vehicle hears, the gain of its own D y (see Input) [1/s^2].
double own_speed_gain(const VehicleModel& vehicle, double sample_period);

}  // namespace platoon
