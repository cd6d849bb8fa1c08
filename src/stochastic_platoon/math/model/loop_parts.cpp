#include "stochastic_platoon/math/model/loop_parts.hpp"

#include <array>
#include <stdexcept>
#include <utility>

#include "stochastic_platoon/math/model/exact_transfer.hpp"
#include "stochastic_platoon/math/model/loop_design.hpp"
#include "stochastic_platoon/math/model/vector_clones.hpp"

namespace platoon {

namespace {

constexpr std::size_t kLanes = 32;  // realizations per pass

/// The canonical form of n / d, both multiplied by powers of z = 1 + s so that n / d alone is the fraction.
DeltaFilter delta_filter(ExactPolynomial n, const ExactPolynomial& d, const Exact& gain) {
  if (n.size() > d.size()) throw std::invalid_argument("controller: must be proper: no more zeros than poles");
  n.resize(d.size(), Exact(0));
  const std::size_t order = d.size() - 1;
  const Exact direct = n[order];
  DeltaFilter filter;
  for (std::size_t j = order; j-- > 0;) {
    filter.a.push_back(d[j].convert_to<double>());
    filter.b.push_back(Exact(gain * (n[j] - direct * d[j])).convert_to<double>());
  }
  filter.direct = Exact(gain * direct).convert_to<double>();
  return filter;
}

// State of one realization after one step; the order of operations is that of the batch.
std::vector<double> advanced(const LoopParts& parts, const std::vector<double>& state, double input) {
  const std::size_t n = parts.plant.order(), m = parts.controller.order();
  std::vector<double> next = state;
  const auto filter = [&](const DeltaFilter& part, std::size_t first, double u) {
    for (std::size_t j = 0; j < part.order(); ++j) {
      const double following = j + 1 < part.order() ? state[first + j + 1] : 0.0;
      next[first + j] = state[first + j] + (following - part.a[j] * state[first] + part.b[j] * u);
    }
  };
  const double y = state[0], e = input - y - parts.headway * (y - state[n + m]);
  double u = parts.controller.direct * e + (m > 0 ? state[n] : 0.0);
  filter(parts.controller, n, e);
  next[n + m] = y;
  const std::size_t last_input = n + m + 1;
  if (parts.headway_filter) u = state[last_input] + (u - state[last_input]) / (1.0 + parts.headway);
  filter(parts.plant, 0, parts.delay > 0 ? state[last_input + parts.delay - 1] : u);
  for (std::size_t j = 0; last_input + j < state.size(); ++j)
    next[last_input + j] = j == 0 ? u : state[last_input + j - 1];
  return next;
}

// States of y = 1 at rest.
std::vector<double> unit_equilibrium(const LoopParts& parts) {
  double u = 0.0;  // of G(1) u = 1
  if (parts.plant.a.back() != 0.0) u = parts.plant.a.back() / parts.plant.b.back();
  std::vector<double> state{1.0};
  for (std::size_t j = 0; j + 1 < parts.plant.order(); ++j) state.push_back(parts.plant.a[j] - parts.plant.b[j] * u);
  if (parts.controller.order() > 0) state.push_back(u);
  for (std::size_t j = 0; j + 1 < parts.controller.order(); ++j) state.push_back(parts.controller.a[j] * u);
  state.push_back(1.0);
  state.resize(parts.order(), u);
  return state;
}

}  // namespace

std::size_t LoopParts::order() const {
  const std::size_t inputs = delay > 0 ? delay : headway_filter ? 1 : 0;
  return plant.order() + controller.order() + 1 + inputs;
}

LoopParts loop_parts(const LoopDesign& design, double headway) {
  const auto size = [](const ExactPolynomial& p) { return static_cast<std::ptrdiff_t>(p.size()); };
  const ExactTransfer& plant = design.plant.exact();
  const ExactTransfer& controller = design.controller.exact();
  // The plant keeps as many poles at z = 0 as it needs to be strictly proper; all others are the delay.
  const std::ptrdiff_t kept = std::max<std::ptrdiff_t>(size(plant.numerator) - size(plant.denominator) + 1, 0);
  const std::ptrdiff_t delay = plant.delay - kept;
  if (delay < 0) throw std::invalid_argument("plant: must be strictly proper: more poles than zeros");
  LoopParts parts;
  parts.plant = delta_filter(plant.numerator, times_power_of_z(plant.denominator, kept), Exact(1));
  const Exact gain = design.divide_by_one_plus_headway ? Exact(1) / (Exact(1) + Exact(headway)) : Exact(1);
  parts.controller = delta_filter(times_power_of_z(controller.numerator, -controller.delay),
                                  times_power_of_z(controller.denominator, controller.delay), gain);
  parts.delay = static_cast<std::size_t>(delay);
  parts.headway = headway;
  parts.headway_filter = design.headway_filter;
  return parts;
}

StateSpace realization(const LoopParts& parts) {
  const std::size_t order = parts.order();
  const auto size = static_cast<Eigen::Index>(order);
  const auto column = [](const std::vector<double>& values) {
    return Eigen::VectorXd::Map(values.data(), static_cast<Eigen::Index>(values.size()));
  };
  Eigen::MatrixXd a(size, size);
  for (std::size_t j = 0; j < order; ++j) {
    std::vector<double> unit(order, 0.0);
    unit[j] = 1.0;
    a.col(static_cast<Eigen::Index>(j)) = column(advanced(parts, unit, 0.0));
  }
  const Eigen::VectorXd b = column(advanced(parts, std::vector<double>(order, 0.0), 1.0));
  return {a, b, Eigen::RowVectorXd::Unit(size, 0)};
}

namespace detail {

// x_j += x_{j+1} - a_j y + b_j u, state by state.
PLATOON_INLINE void advance_filter(const DeltaFilter& part, std::size_t lanes, const double* y, const double* u,
                                   double* state) {
  const std::size_t order = part.order();
  for (std::size_t j = 0; j < order; ++j) {
    const double a = part.a[j], b = part.b[j];
    double* const x = state + j * kTile;
    if (j + 1 == order) {
      for (std::size_t r = 0; r < lanes; ++r) x[r] = x[r] + (0.0 - a * y[r] + b * u[r]);
    } else if (a == 0.0 && b == 0.0) {
      for (std::size_t r = 0; r < lanes; ++r) x[r] = x[r] + x[r + kTile];
    } else {
      for (std::size_t r = 0; r < lanes; ++r) x[r] = x[r] + (x[r + kTile] - a * y[r] + b * u[r]);
    }
  }
}

PLATOON_INLINE void parts_lanes(const LoopParts& parts, std::size_t place, std::size_t lanes, double* state,
                                const double* input, double offset, double* positions) {
  std::array<double, kLanes> y, e, u, first;
  double* const controller = state + parts.plant.order() * kTile;
  double* const before = controller + parts.controller.order() * kTile;
  double* const inputs = before + kTile;  // with a headway filter and no delay, u(k-1) alone
  for (std::size_t r = 0; r < lanes; ++r) {
    y[r] = state[r];
    e[r] = input[r] - offset - y[r] - parts.headway * (y[r] - before[r]);
    before[r] = y[r];
  }
  for (std::size_t r = 0; r < lanes; ++r) first[r] = parts.controller.order() > 0 ? controller[r] : 0.0;
  for (std::size_t r = 0; r < lanes; ++r) u[r] = parts.controller.direct * e[r] + first[r];
  advance_filter(parts.controller, lanes, first.data(), e.data(), controller);
  if (parts.headway_filter) {
    const std::size_t last = parts.delay > 1 ? (place + parts.delay - 1) % parts.delay : 0;
    const double* const x = inputs + last * kTile;
    const double divisor = 1.0 + parts.headway;
    for (std::size_t r = 0; r < lanes; ++r) u[r] = x[r] + (u[r] - x[r]) / divisor;
  }
  if (parts.delay > 0 || parts.headway_filter) {
    double* const x = inputs + place * kTile;
    for (std::size_t r = 0; r < lanes; ++r) {
      const double delayed = parts.delay > 0 ? x[r] : u[r];
      x[r] = u[r];
      u[r] = delayed;
    }
  }
  advance_filter(parts.plant, lanes, y.data(), u.data(), state);
  for (std::size_t r = 0; r < lanes; ++r) positions[r] = state[r];
}

PLATOON_VECTOR_CLONES
void parts_tile(const LoopParts& parts, std::size_t place, std::size_t size, double* state, const double* input,
                double offset, double* positions) {
  std::size_t r = 0;
  for (; r + kLanes <= size; r += kLanes)
    parts_lanes(parts, place, kLanes, state + r, input + r, offset, positions + r);
  parts_lanes(parts, place, size - r, state + r, input + r, offset, positions + r);
}

}  // namespace detail

LoopPartsBatch::LoopPartsBatch(LoopParts parts) : parts_(std::move(parts)), equilibrium_(unit_equilibrium(parts_)) {}

void LoopPartsBatch::start_at_equilibrium(const std::vector<double>& positions) {
  size_ = positions.size();
  place_ = 0;
  const std::size_t order = equilibrium_.size();
  state_.resize((size_ + kTile - 1) / kTile * order * kTile);
  for (std::size_t r = 0; r < size_; ++r) {
    double* const state = &state_[r / kTile * order * kTile + r % kTile];
    for (std::size_t j = 0; j < order; ++j) state[j * kTile] = equilibrium_[j] * positions[r];
  }
}

void LoopPartsBatch::step(const double* input, double offset, double* positions) {
  for (std::size_t first = 0; first < size_; first += kTile) {
    detail::parts_tile(parts_, place_, std::min(kTile, size_ - first), &state_[first * equilibrium_.size()],
                       input + first, offset, positions + first);
  }
  if (parts_.delay > 0) place_ = (place_ + 1) % parts_.delay;
}

void LoopPartsBatch::output(std::vector<double>& positions) const {
  positions.resize(size_);
  for (std::size_t first = 0; first < size_; first += kTile)
    std::copy_n(&state_[first * equilibrium_.size()], std::min(kTile, size_ - first), &positions[first]);
}

}  // namespace platoon
