#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "stochastic_platoon/math/model/loop_batch.hpp"
#include "stochastic_platoon/math/model/manoeuvre.hpp"
#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/math/noise/white_noise.hpp"

namespace platoon {

/// Vehicle i >= 1. Starts at its place in formation + p_i, with p_i ~ N(mean, variance) drawn at step -1. Its input is
/// the received position of its predecessor minus delta.
class FollowerVehicle {
public:
  /// Throws std::invalid_argument unless the variance of the initial positions is finite and >= 0.
  FollowerVehicle(const PlatoonModel& model, const WhiteNoise& noise, std::uint32_t index);

  /// Step -1 of realizations first .. first + count - 1; writes y_i(-1) [m].
  void start(std::uint64_t first_realization, std::size_t count, std::vector<double>& positions);

  /// Computes the vehicle's position at step k + 1 from the predecessor's received position at step k. All arrays have
  /// the size of the batch. A vehicle with feed-forward also needs the predecessor's input as received at step k; any
  /// vehicle by parts writes its own input u(k), which is sent at step k + 1 (see FeedForward).
  void step(const double* received, double* positions, const double* heard = nullptr, double* own_input = nullptr) {
    loop_->step(received, standstill_distance_, positions, {heard, feed_forward_gain_, own_input});
  }
  void step(const std::vector<double>& received, std::vector<double>& positions) {
    positions.resize(received.size());
    step(received.data(), positions.data());
  }

private:
  std::unique_ptr<LoopBatch> loop_;
  WhiteNoise noise_;
  double initial_place_ = 0.0;      ///< mean [m]
  double initial_deviation_ = 0.0;  ///< [m]
  double standstill_distance_ = 0.0;
  double feed_forward_gain_ = 0.0;  ///< F; 0 without a radio
  std::uint32_t index_;
};

/// Vehicle 0: the same closed loop, in equilibrium at 0 and driven noise-free by the virtual leader r_0, or its
/// recorded positions if the model has them. One realization serves for all, as vehicle 0 has no random input.
class LeaderVehicle {
public:
  explicit LeaderVehicle(const PlatoonModel& model);

  /// y_0(-1) [m].
  double start();

  /// y_0 of the next step [m]. Throws std::out_of_range beyond the end of a recording.
  double step();

  /// The input u_0 that led to the position of the latest step() [m/s^2]; 0 at step -1. Vehicles by parts only.
  double input() const { return control_; }

  /// Manoeuvre of the virtual leader that replaces its profile until the next start().
  Manoeuvre& manoeuvre() { return manoeuvre_; }

private:
  std::unique_ptr<LoopBatch> loop_;
  LeaderProfile profile_;
  double sample_period_;  ///< T_s [s]
  Manoeuvre manoeuvre_;
  double departure_ = 0.0;        ///< departure of r_0 from its profile due to manoeuvres [m]
  std::vector<double> recorded_;  ///< y_0(-1), y_0(0), ... [m]; empty: computed by the loop
  std::int64_t step_ = -1;
  std::vector<double> buffer_;
  double control_ = 0.0;  ///< u_0(k-1) [m/s^2]
};

}  // namespace platoon
