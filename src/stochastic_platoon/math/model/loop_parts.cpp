#include "stochastic_platoon/math/model/loop_parts.hpp"

#include <array>
#include <stdexcept>
#include <utility>

#include "stochastic_platoon/math/model/exact_transfer.hpp"
#include "stochastic_platoon/math/model/loop_design.hpp"
#include "stochastic_platoon/math/numerics/vector_clones.hpp"

namespace platoon {

namespace {

constexpr std::size_t kPartLanes = 32;  // realizations per pass

/// The canonical form of n / d, both multiplied by powers of z = 1 + s so that n / d alone is the fraction.
template <class Scalar>
BasicDeltaFilter<Scalar> delta_filter(ExactPolynomial n, const ExactPolynomial& d, const Exact& gain) {
  if (n.size() > d.size()) throw std::invalid_argument("controller: must be proper: no more zeros than poles");
  n.resize(d.size(), Exact(0));
  const std::size_t order = d.size() - 1;
  const Exact direct = n[order];
  BasicDeltaFilter<Scalar> filter;
  for (std::size_t j = order; j-- > 0;) {
    filter.a.push_back(d[j].convert_to<Scalar>());
    filter.b.push_back(Exact(gain * (n[j] - direct * d[j])).template convert_to<Scalar>());
  }
  filter.direct = Exact(gain * direct).convert_to<Scalar>();
  return filter;
}

template <class Scalar>
void advance_filter(const BasicDeltaFilter<Scalar>& part, Scalar* state, Scalar y, Scalar u) {
  for (std::size_t j = 0; j < part.order(); ++j) {
    const Scalar following = j + 1 < part.order() ? state[j + 1] : 0;
    state[j] = state[j] + (following - part.a[j] * y + part.b[j] * u);
  }
}

}  // namespace

template <class Scalar>
Scalar advance(const BasicLoopParts<Scalar>& parts, std::vector<Scalar>& state, Scalar position, Scalar fed_forward) {
  const std::size_t n = parts.plant.order(), m = parts.controller.order();
  Scalar* const controller = state.data() + n;
  Scalar* const before = controller + m;
  Scalar* const inputs = before + 1;
  const Scalar y = state[0], e = position - y - parts.headway * (y - *before), first = m > 0 ? *controller : 0;
  Scalar u = parts.controller.direct * e + first + fed_forward;
  advance_filter(parts.controller, controller, first, e);
  *before = y;
  if (parts.headway_filter) u = *inputs + (u - *inputs) / (1 + parts.headway);
  advance_filter(parts.plant, state.data(), y, parts.delay > 0 ? inputs[parts.delay - 1] : u);
  const std::size_t kept = parts.order() - n - m - 1;
  for (std::size_t j = kept; j-- > 1;) inputs[j] = inputs[j - 1];
  if (kept > 0) *inputs = u;
  return u;
}

template <class Scalar>
std::vector<Scalar> unit_equilibrium(const BasicLoopParts<Scalar>& parts) {
  Scalar u = 0;  // solves G(1) u = 1
  if (parts.plant.a.back() != 0) u = parts.plant.a.back() / parts.plant.b.back();
  std::vector<Scalar> state{1};
  for (std::size_t j = 0; j + 1 < parts.plant.order(); ++j) state.push_back(parts.plant.a[j] - parts.plant.b[j] * u);
  if (parts.controller.order() > 0) state.push_back(u);
  for (std::size_t j = 0; j + 1 < parts.controller.order(); ++j) state.push_back(parts.controller.a[j] * u);
  state.push_back(1);
  state.resize(parts.order(), u);
  return state;
}

template <class Scalar>
BasicLoopParts<Scalar> loop_parts(const LoopDesign& design, double headway) {
  const auto size = [](const ExactPolynomial& p) { return static_cast<std::ptrdiff_t>(p.size()); };
  const ExactTransfer& plant = design.plant.exact();
  const ExactTransfer& controller = design.controller.exact();
  // The plant keeps as many poles at z = 0 as it needs to be strictly proper; all others are the delay.
  const std::ptrdiff_t kept = std::max<std::ptrdiff_t>(size(plant.numerator) - size(plant.denominator) + 1, 0);
  const std::ptrdiff_t delay = plant.delay - kept;
  if (delay < 0) throw std::invalid_argument("plant: must be strictly proper: more poles than zeros");
  BasicLoopParts<Scalar> parts;
  parts.plant = delta_filter<Scalar>(plant.numerator, times_power_of_z(plant.denominator, kept), Exact(1));
  const Exact gain = design.divide_by_one_plus_headway ? Exact(1) / (Exact(1) + Exact(headway)) : Exact(1);
  parts.controller = delta_filter<Scalar>(times_power_of_z(controller.numerator, -controller.delay),
                                          times_power_of_z(controller.denominator, controller.delay), gain);
  parts.delay = static_cast<std::size_t>(delay);
  parts.headway = headway;
  parts.headway_filter = design.headway_filter;
  return parts;
}

template BasicLoopParts<double> loop_parts(const LoopDesign&, double);
template BasicLoopParts<long double> loop_parts(const LoopDesign&, double);
template double advance(const LoopParts&, std::vector<double>&, double, double);
template long double advance(const BasicLoopParts<long double>&, std::vector<long double>&, long double, long double);
template std::vector<double> unit_equilibrium(const LoopParts&);
template std::vector<long double> unit_equilibrium(const BasicLoopParts<long double>&);

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
    advance(parts, unit, 0.0, 0.0);
    a.col(static_cast<Eigen::Index>(j)) = column(unit);
  }
  std::vector<double> driven(order, 0.0);
  advance(parts, driven, 1.0, 0.0);
  const Eigen::VectorXd b = column(driven);
  return {a, b, Eigen::RowVectorXd::Unit(size, 0)};
}

namespace detail {

// x_j += x_{j+1} - a_j y + b_j u, state by state.
PLATOON_INLINE void advance_filter(const BasicDeltaFilter<double>& part, std::size_t lanes, const double* y,
                                   const double* u, double* state) {
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

PLATOON_INLINE ControlInputs from(const ControlInputs& control, std::size_t r) {
  return {control.heard == nullptr ? nullptr : control.heard + r, control.gain,
          control.own == nullptr ? nullptr : control.own + r};
}

PLATOON_INLINE void parts_lanes(const LoopParts& parts, std::size_t place, std::size_t lanes, double* state,
                                const double* input, double offset, double* positions, const ControlInputs& control) {
  std::array<double, kPartLanes> y, e, u, first;
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
  if (control.heard != nullptr) {
    for (std::size_t r = 0; r < lanes; ++r) u[r] = u[r] + control.gain * control.heard[r];
  }
  if (parts.headway_filter) {
    const std::size_t last = parts.delay > 1 ? (place + parts.delay - 1) % parts.delay : 0;
    const double* const x = inputs + last * kTile;
    const double divisor = 1.0 + parts.headway;
    for (std::size_t r = 0; r < lanes; ++r) u[r] = x[r] + (u[r] - x[r]) / divisor;
  }
  if (control.own != nullptr) {
    for (std::size_t r = 0; r < lanes; ++r) control.own[r] = u[r];
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
                double offset, double* positions, const ControlInputs& control) {
  std::size_t r = 0;
  for (; r + kPartLanes <= size; r += kPartLanes)
    parts_lanes(parts, place, kPartLanes, state + r, input + r, offset, positions + r, from(control, r));
  parts_lanes(parts, place, size - r, state + r, input + r, offset, positions + r, from(control, r));
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

void LoopPartsBatch::step(const double* input, double offset, double* positions, const ControlInputs& control) {
  for (std::size_t first = 0; first < size_; first += kTile) {
    detail::parts_tile(parts_, place_, std::min(kTile, size_ - first), &state_[first * equilibrium_.size()],
                       input + first, offset, positions + first, detail::from(control, first));
  }
  if (parts_.delay > 0) place_ = (place_ + 1) % parts_.delay;
}

void LoopPartsBatch::output(std::vector<double>& positions) const {
  positions.resize(size_);
  for (std::size_t first = 0; first < size_; first += kTile)
    std::copy_n(&state_[first * equilibrium_.size()], std::min(kTile, size_ - first), &positions[first]);
}

}  // namespace platoon
