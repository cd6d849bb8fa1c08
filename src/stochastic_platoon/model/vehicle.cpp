#include "stochastic_platoon/model/vehicle.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "stochastic_platoon/model/vector_clones.hpp"

namespace platoon {

namespace {

constexpr std::size_t kLanes = 32;  // what of u and y stays in registers

struct Gains {
  const double* output;
  const double* input;
  std::size_t order;
};

// ClosedLoopBatch's step for some realizations of a tile; state, input and positions begin with those.
PLATOON_INLINE void step_lanes(const Gains& gains, std::size_t output_place, std::size_t lanes, double* state,
                               const double* input, double offset, double* positions) {
  std::array<double, kLanes> u, y;
  double* place = state + output_place * kTile;
  for (std::size_t r = 0; r < lanes; ++r) u[r] = input[r] - offset;
  for (std::size_t r = 0; r < lanes; ++r) y[r] = place[r];
  for (std::size_t j = 0; j + 1 < gains.order; ++j) {
    place = place == state + (gains.order - 1) * kTile ? state : place + kTile;
    const double a = gains.output[j];
    const double b = gains.input[j];
    for (std::size_t r = 0; r < lanes; ++r) place[r] = a * y[r] + place[r] + b * u[r];
  }
  place = state + output_place * kTile;
  const double a = gains.output[gains.order - 1];
  const double b = gains.input[gains.order - 1];
  for (std::size_t r = 0; r < lanes; ++r) place[r] = a * y[r] + b * u[r];
  const double* output = state + (output_place + 1) % gains.order * kTile;
  for (std::size_t r = 0; r < lanes; ++r) positions[r] = output[r];
}

// The realization itself, if its y is its first state and what else a state hears is the next one.
StateSpace in_observable_coordinates(const StateSpace& system) {
  const Eigen::Index n = system.order();
  Eigen::MatrixXd shift = Eigen::MatrixXd::Zero(n, n);
  shift.col(0) = system.a().col(0);
  shift.diagonal(1).setOnes();
  const bool already = system.a() == shift && system.c() == Eigen::RowVectorXd::Unit(n, 0);
  return already ? system : observable_canonical(transfer_function(system));
}

}  // namespace

namespace detail {

PLATOON_VECTOR_CLONES
void step_tile(const Gains& gains, std::size_t output_place, std::size_t size, double* state,
               const double* input, double offset, double* positions) {
  const Gains here = gains;  // a copy, which writing the state cannot change
  std::size_t r = 0;
  for (; r + kLanes <= size; r += kLanes)
    step_lanes(here, output_place, kLanes, state + r, input + r, offset, positions + r);
  step_lanes(here, output_place, size - r, state + r, input + r, offset, positions + r);
}

// out = in + value out
PLATOON_VECTOR_CLONES
void scale_and_add(double value, const double* in, std::size_t size, double* out) {
  for (std::size_t r = 0; r < size; ++r) out[r] = in[r] + value * out[r];
}

}  // namespace detail

ClosedLoopBatch::ClosedLoopBatch(const StateSpace& system) {
  const StateSpace canonical = in_observable_coordinates(system);
  const Eigen::VectorXd rest = unit_rest_state(canonical);
  for (Eigen::Index j = 0; j < canonical.order(); ++j) {
    output_gain_.push_back(canonical.a()(j, 0));
    input_gain_.push_back(canonical.b()(j));
    rest_state_.push_back(rest(j));
  }
}

void ClosedLoopBatch::rest_at(const std::vector<double>& positions) {
  size_ = positions.size();
  output_place_ = 0;
  state_.resize(tiles() * order() * kTile);
  for (std::size_t t = 0; t < tiles(); ++t) {
    for (std::size_t j = 0; j < order(); ++j) {
      double* state = &state_[(t * order() + j) * kTile];
      for (std::size_t r = 0; r < tile_size(t); ++r) state[r] = rest_state_[j] * positions[t * kTile + r];
    }
  }
}

void ClosedLoopBatch::step(const std::vector<double>& input, double offset, std::vector<double>& positions) {
  positions.resize(size_);
  const Gains gains{output_gain_.data(), input_gain_.data(), order()};
  for (std::size_t t = 0; t < tiles(); ++t) {
    detail::step_tile(gains, output_place_, tile_size(t), &state_[t * order() * kTile], &input[t * kTile],
                      offset, &positions[t * kTile]);
  }
  output_place_ = (output_place_ + 1) % order();
}

void ClosedLoopBatch::output(std::vector<double>& positions) const {
  positions.resize(size_);
  for (std::size_t t = 0; t < tiles(); ++t) {
    const double* output = &state_[(t * order() + output_place_) * kTile];
    std::copy(output, output + tile_size(t), &positions[t * kTile]);
  }
}

FollowerVehicle::FollowerVehicle(const PlatoonModel& model, std::uint64_t seed, std::uint32_t index)
    : loop_(model.loop.realization),
      noise_(seed),
      initial_(model.initial_position),
      standstill_distance_(model.standstill_distance),
      index_(index) {}

void FollowerVehicle::start(std::uint64_t first_realization, std::size_t count,
                            std::vector<double>& positions) {
  positions.resize(count);
  const double place = initial_.mean - static_cast<double>(index_) * standstill_distance_;
  if (initial_.variance > 0.0) {
    const double deviation = std::sqrt(initial_.variance);
    noise_.fill({index_, -1}, first_realization, count, positions.data());
    for (double& position : positions) position = place + deviation * position;
  } else {
    positions.assign(count, place);
  }
  loop_.rest_at(positions);
  loop_.output(positions);
}

void FollowerVehicle::step(const std::vector<double>& received, std::vector<double>& positions) {
  loop_.step(received, standstill_distance_, positions);
}

LeaderVehicle::LeaderVehicle(const PlatoonModel& model)
    : loop_(model.loop.realization), profile_(model.leader), buffer_(1), input_(1) {}

double LeaderVehicle::start() {
  step_ = -1;
  buffer_.assign(1, profile_.position(step_));
  loop_.rest_at(buffer_);
  loop_.output(buffer_);
  return buffer_.front();
}

double LeaderVehicle::step() {
  input_.front() = profile_.position(step_);
  loop_.step(input_, 0.0, buffer_);
  ++step_;
  return buffer_.front();
}

NoisyChannel::NoisyChannel(double noise_variance, std::uint64_t seed, std::uint32_t receiver)
    : noise_(seed), deviation_(std::sqrt(noise_variance)), receiver_(receiver) {}

void NoisyChannel::transmit(std::int64_t step, std::uint64_t first_realization,
                            const std::vector<double>& sent, std::vector<double>& received) const {
  if (step < 0 || deviation_ == 0.0) {
    received = sent;
    return;
  }
  received.resize(sent.size());
  for (std::size_t r = 0; r < sent.size(); r += kTile) {
    const std::size_t size = std::min(kTile, sent.size() - r);
    noise_.fill({receiver_, step}, first_realization + r, size, &received[r]);
    detail::scale_and_add(deviation_, &sent[r], size, &received[r]);
  }
}

}  // namespace platoon
