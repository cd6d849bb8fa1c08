#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "stochastic_platoon/math/model/loop_batch.hpp"
#include "stochastic_platoon/math/model/manoeuvre.hpp"
#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/math/noise/white_noise.hpp"

namespace platoon {

/// A closed loop computed by its realization: x(k+1) = A x(k) + B u(k), y(k) = C x(k), eq.
/// (ith-closedloop).
///
/// The observable canonical form, which plant and controller give, is a shift register,
/// \f[ x_j(k+1) = a_j y(k) + x_{j+1}(k) + b_j u(k), \qquad x_n = 0, \qquad y = x_0, \qquad j = 0, \ldots, n - 1: \f]
/// x_j(k+1) overwrites x_{j+1}(k), and x_{n-1}(k+1) overwrites y(k), so one pass over the state computes the step.
/// Other realizations are computed with their matrices.
///
/// Every realization undergoes the same operations in the same order, so its bits do not depend on the batch.
class ClosedLoopBatch : public LoopBatch {
public:
  /// Throws std::invalid_argument if the loop has no equilibrium.
  explicit ClosedLoopBatch(const StateSpace& system);

  /// x = (I - A)^-1 B p / T(1): equilibrium with y = p at these positions p [m].
  void start_at_equilibrium(const std::vector<double>& positions) override;

  /// One step with the input [m] minus offset [m]; writes y = C x [m]. Both arrays have the size of the batch. The
  /// canonical form has no control inputs.
  void step(const double* input, double offset, double* positions, const ControlInputs& none) override;
  using LoopBatch::step;
  void step(const std::vector<double>& input, double offset, std::vector<double>& positions) {
    positions.resize(size_);
    step(input.data(), offset, positions.data());
  }

  /// y = C x [m], resized to the batch.
  void output(std::vector<double>& positions) const override;

private:
  std::size_t order() const { return b_.size(); }
  std::size_t tiles() const { return (size_ + kTile - 1) / kTile; }
  std::size_t tile_size(std::size_t tile) const { return std::min(kTile, size_ - tile * kTile); }

  bool shift_register_;
  std::vector<double> a_;            ///< A row by row; its first column for a shift register
  std::vector<double> b_;            ///< B
  std::vector<double> c_;            ///< C; empty for a shift register
  std::vector<double> equilibrium_;  ///< (I - A)^-1 B / T(1)
  std::size_t size_ = 0;             ///< realizations
  std::size_t output_place_ = 0;     ///< place of x_0; x_j is j places further, modulo n
  AlignedValues state_;              ///< tile by tile, place by place
  AlignedValues next_;               ///< next state of one tile, to be copied; empty for a shift register
};

/// Vehicle i >= 1. Starts at its place in formation + p_i, with p_i ~ N(mean, variance) drawn at step -1. Its input is
/// the received position of its predecessor minus delta.
class FollowerVehicle {
public:
  /// Throws std::invalid_argument unless the variance of the initial positions is finite and >= 0.
  FollowerVehicle(const PlatoonModel& model, std::uint64_t seed, std::uint32_t index);

  /// Step -1 of realizations first .. first + count - 1; writes y_i(-1) [m].
  void start(std::uint64_t first_realization, std::size_t count, std::vector<double>& positions);

  /// Computes the own position at step k + 1 from the predecessor's received position at step k. All arrays have the
  /// size of the batch. A vehicle with feed-forward also needs the predecessor's input as received at step k; any
  /// vehicle by parts writes its own input u(k), which is sent at step k + 1 (see FeedForward).
  void step(const double* received, double* positions, const double* heard = nullptr, double* own_input = nullptr) {
    loop_->step(received, standstill_distance_, positions, {heard, feed_forward_gain_, own_input});
  }
  void step(const std::vector<double>& received, std::vector<double>& positions) {
    positions.resize(received.size());
    step(received.data(), positions.data());
  }

private:
  FollowerVehicle(const VehicleModel& own, double place, std::uint64_t seed, std::uint32_t index);

  std::unique_ptr<LoopBatch> loop_;
  WhiteNoise noise_;
  double initial_place_;      ///< mean [m]
  double initial_deviation_;  ///< [m]
  double standstill_distance_;
  double feed_forward_gain_;  ///< F; 0 without a radio
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
  std::vector<double> buffer_, input_;
  double control_ = 0.0;  ///< u_0(k-1) [m/s^2]
};

/// sqrt(P_d) [m]. Throws std::invalid_argument unless P_d is finite and >= 0.
double noise_deviation(double noise_variance);

/// The paper's channel into vehicle i: received = sent + d_i(k), with d_i(k) = sqrt(P_d) g(seed, i, k, r) for k >= 0
/// and 0 for k = -1 (paper, assumption d and e). Stateless.
class AwgnChannel {
public:
  /// noise_variance is P_d [m^2], receiver is i >= 1. Throws std::invalid_argument unless P_d is finite and >= 0.
  AwgnChannel(double noise_variance, std::uint64_t seed, std::uint32_t receiver);

  /// sent and received: one position per realization first_realization .. first_realization + count - 1 [m].
  void transmit(std::int64_t step, std::uint64_t first_realization, const double* sent, std::size_t count,
                double* received) const;
  void transmit(std::int64_t step, std::uint64_t first_realization, const std::vector<double>& sent,
                std::vector<double>& received) const {
    received.resize(sent.size());
    transmit(step, first_realization, sent.data(), sent.size(), received.data());
  }

private:
  WhiteNoise noise_;
  double deviation_;  ///< sqrt(P_d) [m]
  std::uint32_t receiver_;
};

}  // namespace platoon
