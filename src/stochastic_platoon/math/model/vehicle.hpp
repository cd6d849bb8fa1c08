#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "stochastic_platoon/math/model/loop_batch.hpp"
#include "stochastic_platoon/math/model/manoeuvre.hpp"
#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/math/model/recent_positions.hpp"
#include "stochastic_platoon/math/noise/white_noise.hpp"
#include "stochastic_platoon/math/numerics/aligned_values.hpp"

namespace platoon {

/// Vehicle i >= 1. Starts at its start_place() + p_i, with p_i ~ N(mean, variance) drawn at step -1.
class FollowerVehicle {
public:
  /// Throws std::invalid_argument unless the variance of the initial positions is finite and >= 0.
  FollowerVehicle(const PlatoonModel& model, const WhiteNoise& noise, std::uint32_t index);

  /// Step -1 of realizations first .. first + count - 1; writes y_i(-1) [m].
  void start(std::uint64_t first_realization, std::size_t count, std::vector<double>& positions);

  using Received = std::vector<const double*>;

  /// Computes the vehicle's position at step k + 1 from its inputs as received at step k, in the order of
  /// VehicleModel::inputs. All arrays have the size of the batch. A vehicle by parts writes its own input u(k), which
  /// is sent at step k + 1 (see Input), unless that is null.
  void step(const Received& received, double* positions, double* own_input = nullptr);
  void step(const std::vector<double>& received, std::vector<double>& positions) {
    positions.resize(received.size());
    step({received.data()}, positions.data());
  }

private:
  /// The sums over the inputs of a vehicle that hears others than its predecessor.
  struct Sums {
    struct Share {
      bool is_position;
      double gain;
    };
    std::vector<Share> shares;           ///< of each input, in the sum of the positions or in the other one
    double own_speed, own_acceleration;  ///< gains of D y [1/s^2] and D^2 y [1/s^2]
    RecentPositions own = {};
    AlignedValues position = {}, forward = {};  ///< of the positions, and of all other signals
  };
  void sum(const Received& received);

  std::unique_ptr<LoopBatch> loop_;
  WhiteNoise noise_;
  double initial_place_ = 0.0;      ///< mean [m]
  double slope_ = 0.0;              ///< start_slope() [m]
  double initial_deviation_ = 0.0;  ///< [m]
  double offset_ = 0.0;             ///< delta, times the spacing_in_vehicles() [m]
  double feed_forward_gain_ = 0.0;  ///< F; 0 without a radio
  std::optional<Sums> sums_;        ///< none: the vehicle hears its predecessor alone
  std::uint32_t index_;
};

/// Vehicle 0: the same closed loop, in equilibrium at 0 and driven noise-free by the virtual leader r_0; or r_0 itself
/// if the model moves_leader(), or its recorded positions. At step -1 it moves by start_slope() per step and y_0(0) = 0
/// in steady motion. One realization serves for all, as vehicle 0 has no random input.
class LeaderVehicle {
public:
  explicit LeaderVehicle(const PlatoonModel& model);

  /// y_0(-1) [m].
  double start();

  /// y_0 of the next step [m]. Throws std::out_of_range beyond the end of a recording.
  double step();

  /// The input u_0 that led to the position of the latest step() [m/s^2]; 0 at step -1. Of vehicles by parts, and of a
  /// moved leader: the second difference of its positions over T_s^2.
  double input() const { return control_; }

  /// Manoeuvre of the virtual leader that replaces its profile until the next start(); one ordered before the first
  /// start() begins with it.
  Manoeuvre& manoeuvre() { return manoeuvre_; }

private:
  double virtual_leader() const;
  static constexpr std::int64_t kNotStarted = -2;
  std::unique_ptr<LoopBatch> loop_;  ///< null: moved
  LeaderProfile profile_;
  double sample_period_;  ///< T_s [s]
  Manoeuvre manoeuvre_;
  double slope_, lag_;            ///< start_slope(), and that of the closed loop behind r_0 in steady motion [m]
  double departure_ = 0.0;        ///< departure of r_0 from its profile due to manoeuvres [m]
  std::vector<double> recorded_;  ///< y_0(-1), y_0(0), ... [m]; empty: not recorded
  std::int64_t step_ = kNotStarted;
  std::vector<double> buffer_;
  double moved_ = 0.0;    ///< by the latest step [m]
  double control_ = 0.0;  ///< u_0(k-1) [m/s^2]
};

}  // namespace platoon
