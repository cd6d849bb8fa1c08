#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "stochastic_platoon/math/model/closed_loop.hpp"
#include "stochastic_platoon/math/model/vehicle_limits.hpp"

namespace platoon {

/// Initial position of follower i: -i delta plus N(mean, variance), independent per follower and realization.
struct InitialPosition {
  double mean = 0.0;      ///< [m]
  double variance = 0.0;  ///< [m^2], >= 0
};

struct Input;      // see input.hpp: a file that does not use it need not be compiled again for a new field
struct LinkModel;  // see link_model.hpp

/// Per-follower part of the model: the vehicle, its spacing and what it receives.
struct VehicleModel {
  /// Hears the position of its predecessor.
  VehicleModel(ClosedLoop loop, double headway);
  VehicleModel(const VehicleModel&);
  VehicleModel(VehicleModel&&) noexcept;
  VehicleModel& operator=(const VehicleModel&);
  VehicleModel& operator=(VehicleModel&&) noexcept;
  ~VehicleModel();

  ClosedLoop loop;
  double headway;                    ///< h > 0, in sample periods; 0 with constant_spacing
  double standstill_distance = 0.0;  ///< delta >= 0 [m], to its predecessor
  std::vector<Input> inputs;         ///< the position, and with a radio the control input of the predecessor
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
  const Input* radio() const;  ///< null: none
  Input* radio() { return const_cast<Input*>(const_cast<const VehicleModel*>(this)->radio()); }

  /// The input whose losses input n shares: the first of its packet, else itself.
  std::size_t losses_of(std::size_t n) const;

  /// The inputs whose losses with_loss() varies, by varied_losses(). They are lost together.
  std::vector<std::size_t> varied_inputs() const;
  const LinkModel& varied_link() const;

  /// Calls change(link) with the link of each of them.
  void vary(const std::function<void(LinkModel&)>& change);
};

/// The sum of w_j d_j of a follower (see Input): its distance, in vehicles, that its headway and delta multiply. 1 if
/// it hears its predecessor alone.
double spacing_in_vehicles(const VehicleModel& vehicle, std::size_t follower);

/// The sum of F_j / T_s over the speeds that a vehicle hears, the gain of its own D y (see Input) [1/s^2].
double own_speed_gain(const VehicleModel& vehicle, double sample_period);

}  // namespace platoon
