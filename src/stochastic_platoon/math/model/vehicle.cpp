#include "stochastic_platoon/math/model/vehicle.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "stochastic_platoon/math/numerics/vector_clones.hpp"

namespace platoon {

namespace {

constexpr std::size_t kLanes = 16;  // realizations per pass: their u and y fit in the registers of AVX2

// One step of a shift register for some realizations of a tile; state, input and positions start at the first of these.
PLATOON_INLINE void shift_lanes(const double* a, const double* b, std::size_t order, std::size_t output_place,
                                std::size_t lanes, double* state, const double* input, double offset,
                                double* positions) {
  std::array<double, kLanes> u, y;
  double* const first = state + output_place * kTile;
  double* const last = state + (order - 1) * kTile;
  for (std::size_t r = 0; r < lanes; ++r) u[r] = input[r] - offset;
  for (std::size_t r = 0; r < lanes; ++r) y[r] = first[r];
  double* place = first;
  for (std::size_t j = 0; j + 1 < order; ++j) {
    place = place == last ? state : place + kTile;
    const double a_j = a[j];
    const double b_j = b[j];
    for (std::size_t r = 0; r < lanes; ++r) place[r] = a_j * y[r] + place[r] + b_j * u[r];
  }
  const double a_j = a[order - 1];
  const double b_j = b[order - 1];
  for (std::size_t r = 0; r < lanes; ++r) first[r] = a_j * y[r] + b_j * u[r];
  const double* const output = first == last ? state : first + kTile;
  // Copies through registers, as `positions` could overlap the state.
  for (std::size_t r = 0; r < lanes; ++r) y[r] = output[r];
  for (std::size_t r = 0; r < lanes; ++r) positions[r] = y[r];
}

}  // namespace

namespace detail {

PLATOON_VECTOR_CLONES
void shift_tile(const double* a, const double* b, std::size_t order, std::size_t output_place, std::size_t size,
                double* state, const double* input, double offset, double* positions) {
  std::size_t r = 0;
  for (; r + kLanes <= size; r += kLanes)
    shift_lanes(a, b, order, output_place, kLanes, state + r, input + r, offset, positions + r);
  shift_lanes(a, b, order, output_place, size - r, state + r, input + r, offset, positions + r);
}

// out = row state, summed in the order of the row.
PLATOON_VECTOR_CLONES
void combine(const double* row, std::size_t order, const double* state, std::size_t size, double* out) {
  for (std::size_t r = 0; r < size; ++r) out[r] = row[0] * state[r];
  for (std::size_t j = 1; j < order; ++j) {
    for (std::size_t r = 0; r < size; ++r) out[r] += row[j] * state[j * kTile + r];
  }
}

PLATOON_VECTOR_CLONES
void add_scaled(double value, const double* in, double offset, std::size_t size, double* out) {
  for (std::size_t r = 0; r < size; ++r) out[r] += value * (in[r] - offset);
}

// out = in + value out
PLATOON_VECTOR_CLONES
void scale_and_add(double value, const double* in, std::size_t size, double* out) {
  for (std::size_t r = 0; r < size; ++r) out[r] = in[r] + value * out[r];
}

}  // namespace detail

namespace {

bool is_shift_register(const StateSpace& system) {
  const Eigen::Index n = system.order();
  Eigen::MatrixXd shift = Eigen::MatrixXd::Zero(n, n);
  shift.col(0) = system.a().col(0);
  shift.diagonal(1).setOnes();
  return system.a() == shift && system.c() == Eigen::RowVectorXd::Unit(n, 0);
}

}  // namespace

ClosedLoopBatch::ClosedLoopBatch(const StateSpace& system) : shift_register_(is_shift_register(system)) {
  const Eigen::VectorXd equilibrium = unit_equilibrium(system);
  for (Eigen::Index i = 0; i < system.order(); ++i) {
    for (Eigen::Index j = 0; j < (shift_register_ ? 1 : system.order()); ++j) a_.push_back(system.a()(i, j));
    b_.push_back(system.b()(i));
    if (!shift_register_) c_.push_back(system.c()(i));
    equilibrium_.push_back(equilibrium(i));
  }
  if (!shift_register_) next_.resize(order() * kTile);
}

void ClosedLoopBatch::start_at_equilibrium(const std::vector<double>& positions) {
  size_ = positions.size();
  output_place_ = 0;
  state_.resize(tiles() * order() * kTile);
  for (std::size_t t = 0; t < tiles(); ++t) {
    for (std::size_t j = 0; j < order(); ++j) {
      double* state = &state_[(t * order() + j) * kTile];
      for (std::size_t r = 0; r < tile_size(t); ++r) state[r] = equilibrium_[j] * positions[t * kTile + r];
    }
  }
}

void ClosedLoopBatch::step(const double* input, double offset, double* positions, const ControlInputs&) {
  for (std::size_t t = 0; t < tiles(); ++t) {
    double* const state = &state_[t * order() * kTile];
    const double* const u = input + t * kTile;
    double* const y = positions + t * kTile;
    if (shift_register_) {
      detail::shift_tile(a_.data(), b_.data(), order(), output_place_, tile_size(t), state, u, offset, y);
      continue;
    }
    for (std::size_t i = 0; i < order(); ++i) {
      double* const next = &next_[i * kTile];
      detail::combine(&a_[i * order()], order(), state, tile_size(t), next);
      detail::add_scaled(b_[i], u, offset, tile_size(t), next);
    }
    std::copy(next_.begin(), next_.end(), state);
    detail::combine(c_.data(), order(), state, tile_size(t), y);
  }
  if (shift_register_) output_place_ = (output_place_ + 1) % order();
}

std::unique_ptr<LoopBatch> loop_batch(const ClosedLoop& loop) {
  if (loop.parts) return std::make_unique<LoopPartsBatch>(*loop.parts);
  return std::make_unique<ClosedLoopBatch>(loop.realization);
}

void ClosedLoopBatch::output(std::vector<double>& positions) const {
  positions.resize(size_);
  for (std::size_t t = 0; t < tiles(); ++t) {
    const double* const state = &state_[t * order() * kTile];
    if (shift_register_) {
      std::copy_n(state + output_place_ * kTile, tile_size(t), &positions[t * kTile]);
    } else {
      detail::combine(c_.data(), order(), state, tile_size(t), &positions[t * kTile]);
    }
  }
}

namespace {

// The standard deviation [m] of a variance [m^2].
double root_of(const char* name, double variance) {
  if (!(variance >= 0.0) || !std::isfinite(variance)) {
    throw std::invalid_argument(std::string(name) + ": " + std::to_string(variance) +
                                ": must be finite and >= 0 [m^2]");
  }
  return std::sqrt(variance);
}

}  // namespace

FollowerVehicle::FollowerVehicle(const PlatoonModel& model, std::uint64_t seed, std::uint32_t index)
    : FollowerVehicle(vehicle(model, index), place_in_formation(model, index), seed, index) {}

FollowerVehicle::FollowerVehicle(const VehicleModel& own, double place, std::uint64_t seed, std::uint32_t index)
    : loop_(loop_batch(own.loop)),
      noise_(seed),
      initial_place_(own.initial_position.mean + place),
      initial_deviation_(root_of("variance of the initial positions", own.initial_position.variance)),
      standstill_distance_(own.standstill_distance),
      feed_forward_gain_(own.feed_forward ? own.feed_forward->gain : 0.0),
      index_(index) {}

void FollowerVehicle::start(std::uint64_t first_realization, std::size_t count, std::vector<double>& positions) {
  positions.resize(count);
  if (initial_deviation_ > 0.0) {
    noise_.fill({index_, -1}, first_realization, count, positions.data());
    for (double& position : positions) position = initial_place_ + initial_deviation_ * position;
  } else {
    positions.assign(count, initial_place_);
  }
  loop_->start_at_equilibrium(positions);
  loop_->output(positions);
}

LeaderVehicle::LeaderVehicle(const PlatoonModel& model)
    : loop_(loop_batch(model.default_vehicle().loop)),
      profile_(model.leader),
      sample_period_(model.sample_period),
      manoeuvre_(model.sample_period),
      recorded_(model.recorded_leader),
      buffer_(1),
      input_(1) {}

double LeaderVehicle::start() {
  step_ = -1;
  departure_ = 0.0;
  control_ = 0.0;
  manoeuvre_.end();
  if (!recorded_.empty()) return recorded_.front();
  buffer_.assign(1, profile_.position(step_));
  loop_->start_at_equilibrium(buffer_);
  loop_->output(buffer_);
  return buffer_.front();
}

double LeaderVehicle::step() {
  if (!recorded_.empty()) return recorded_.at(static_cast<std::size_t>(++step_ + 1));
  input_.front() = profile_.position(step_);
  if (departure_ != 0.0) input_.front() += departure_;
  loop_->step(input_.data(), 0.0, buffer_.data(), {nullptr, 0.0, &control_});
  const double speed = profile_.speed(step_);
  departure_ += sample_period_ * (manoeuvre_.next_speed(speed) - speed);
  ++step_;
  return buffer_.front();
}

double noise_deviation(double noise_variance) {
  return root_of("noise variance", noise_variance);
}

AwgnChannel::AwgnChannel(double noise_variance, std::uint64_t seed, std::uint32_t receiver)
    : noise_(seed), deviation_(noise_deviation(noise_variance)), receiver_(receiver) {}

void AwgnChannel::transmit(std::int64_t step, std::uint64_t first_realization, const double* sent, std::size_t count,
                           double* received) const {
  if (step < 0 || deviation_ == 0.0) {
    std::copy_n(sent, count, received);
    return;
  }
  for (std::size_t r = 0; r < count; r += kTile) {
    const std::size_t size = std::min(kTile, count - r);
    noise_.fill({receiver_, step}, first_realization + r, size, received + r);
    detail::scale_and_add(deviation_, sent + r, size, received + r);
  }
}

}  // namespace platoon
