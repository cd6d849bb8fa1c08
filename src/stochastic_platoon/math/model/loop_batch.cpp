#include "stochastic_platoon/math/model/loop_batch.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "stochastic_platoon/math/model/closed_loop.hpp"

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

}  // namespace detail

namespace {

std::vector<double> listed(const Eigen::VectorXd& state) {
  return {state.data(), state.data() + state.size()};
}

/// The observable canonical form, which plant and controller give, is a shift register:
///
///     x_j(k+1) = a_j y(k) + x_{j+1}(k) + b_j u(k),   x_n = 0,   y = x_0,   j = 0, ..., n - 1.
///
/// x_j(k+1) overwrites x_{j+1}(k), and x_{n-1}(k+1) overwrites y(k), so one pass over the state computes the step. The
/// place of x_0 is place(), and x_j is j places further, modulo n.
class ShiftRegisterBatch : public LoopBatch {
public:
  explicit ShiftRegisterBatch(const StateSpace& system)
      : LoopBatch(listed(unit_equilibrium(system)), listed(unit_ramp(system)),
                  static_cast<std::size_t>(system.order())),
        a_(system.a().col(0)),
        b_(system.b()) {}

private:
  void step_tile(double* state, std::size_t size, const double* input, double offset, double* positions,
                 const ControlInputs&) override {
    detail::shift_tile(a_.data(), b_.data(), order(), place(), size, state, input, offset, positions);
  }

  void output_tile(const double* state, std::size_t size, double* positions) const override {
    std::copy_n(state + place() * kTile, size, positions);
  }

  Eigen::VectorXd a_, b_;
};

/// Any other realization, computed with its matrices.
class MatrixBatch : public LoopBatch {
public:
  explicit MatrixBatch(const StateSpace& system)
      : LoopBatch(listed(unit_equilibrium(system)), listed(unit_ramp(system)), 1),
        a_(system.a()),
        b_(system.b()),
        c_(system.c()),
        next_(order() * kTile) {}

private:
  void step_tile(double* state, std::size_t size, const double* input, double offset, double* positions,
                 const ControlInputs&) override {
    for (std::size_t i = 0; i < order(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      double* const next = &next_[i * kTile];
      detail::combine(&a_(row, 0), order(), state, size, next);
      detail::add_scaled(b_(row), input, offset, size, next);
    }
    std::copy(next_.begin(), next_.end(), state);
    output_tile(state, size, positions);
  }

  void output_tile(const double* state, std::size_t size, double* positions) const override {
    detail::combine(c_.data(), order(), state, size, positions);
  }

  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> a_;
  Eigen::VectorXd b_;
  Eigen::RowVectorXd c_;
  AlignedValues next_;  ///< next state of one tile, to be copied
};

bool is_shift_register(const StateSpace& system) {
  const Eigen::Index n = system.order();
  Eigen::MatrixXd shift = Eigen::MatrixXd::Zero(n, n);
  shift.col(0) = system.a().col(0);
  shift.diagonal(1).setOnes();
  return system.a() == shift && system.c() == Eigen::RowVectorXd::Unit(n, 0);
}

}  // namespace

LoopBatch::LoopBatch(std::vector<double> equilibrium, std::vector<double> ramp, std::size_t places)
    : equilibrium_(std::move(equilibrium)), ramp_(std::move(ramp)), places_(places) {}

void LoopBatch::start(const std::vector<double>& positions, double slope) {
  size_ = positions.size();
  place_ = 0;
  state_.resize((size_ + kTile - 1) / kTile * order() * kTile);
  for (std::size_t r = 0; r < size_; ++r) {
    double* const state = &state_[r / kTile * order() * kTile + r % kTile];
    for (std::size_t j = 0; j < order(); ++j) state[j * kTile] = equilibrium_[j] * positions[r];
    if (slope == 0.0) continue;
    for (std::size_t j = 0; j < order(); ++j) state[j * kTile] += ramp_[j] * slope;
  }
}

void LoopBatch::step(const double* input, double offset, double* positions, const ControlInputs& control) {
  for (std::size_t first = 0; first < size_; first += kTile) {
    step_tile(&state_[first * order()], tile_size(first), input + first, offset, positions + first,
              control.from(first));
  }
  place_ = (place_ + 1) % places_;
}

void LoopBatch::output(std::vector<double>& positions) const {
  positions.resize(size_);
  for (std::size_t first = 0; first < size_; first += kTile)
    output_tile(&state_[first * order()], tile_size(first), &positions[first]);
}

std::unique_ptr<LoopBatch> loop_batch(const ClosedLoop& loop) {
  if (loop.parts) return std::make_unique<LoopPartsBatch>(*loop.parts);
  if (is_shift_register(loop.realization)) return std::make_unique<ShiftRegisterBatch>(loop.realization);
  return std::make_unique<MatrixBatch>(loop.realization);
}

}  // namespace platoon
