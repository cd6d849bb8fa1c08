#include "stochastic_platoon/math/model/loop_parts.hpp"

#include <algorithm>
#include <stdexcept>

#include "stochastic_platoon/math/model/exact_transfer.hpp"
#include "stochastic_platoon/math/model/loop_design.hpp"
#include "stochastic_platoon/math/model/part_lanes.hpp"
#include "stochastic_platoon/math/numerics/vector_clones.hpp"

namespace platoon {

namespace {

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
  const Scalar y = state[0], e = position - y - parts.spacing * (y - *before), first = m > 0 ? *controller : 0;
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

// With rates x_j(k+1) - x_j(k) = rest_j, those of y = k at rest: x_{j+1} = rest_j + a_j y - b_j u, and e = 0.
std::vector<double> unit_ramp(const LoopParts& parts) {
  const std::vector<double> rest = unit_equilibrium(parts);
  const std::size_t n = parts.plant.order(), m = parts.controller.order(), inputs = n + m + 1;
  const double rate = inputs < rest.size() ? rest.back() : 0.0;                       // of u
  double u = parts.plant.b.back() == 0.0 ? 0.0 : rest[n - 1] / parts.plant.b.back();  // of the plant, at y = 0
  std::vector<double> state(rest.size(), 0.0);
  for (std::size_t j = 0; j + 1 < n; ++j) state[j + 1] = rest[j] - parts.plant.b[j] * u;
  u += rate * static_cast<double>(parts.delay);
  if (m > 0) state[n] = parts.headway_filter ? u + parts.headway * rate : u;
  for (std::size_t j = 0; j + 1 < m; ++j) state[n + j + 1] = rest[n + j] + parts.controller.a[j] * state[n];
  state[n + m] = -1.0;
  for (std::size_t j = inputs; j < state.size(); ++j) state[j] = u - rate * static_cast<double>(j - inputs + 1);
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
  parts.spacing = headway;
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

PLATOON_VECTOR_CLONES
void parts_tile(const LoopParts& parts, std::size_t place, std::size_t size, double* state, const double* input,
                double offset, double* positions, const ControlInputs& control) {
  step_lanes(parts, FilteredPlant{parts.plant}, Unlimited(), place, size, state, input, offset, positions, control);
}

}  // namespace detail

std::vector<double> in_ring_order(const LoopParts& parts, std::vector<double> state) {
  std::reverse(state.end() - static_cast<std::ptrdiff_t>(parts.delay), state.end());
  return state;
}

LoopPartsBatch::LoopPartsBatch(const LoopParts& parts)
    : LoopBatch(unit_equilibrium(parts), in_ring_order(parts, unit_ramp(parts)), std::max<std::size_t>(parts.delay, 1)),
      parts_(parts) {}

void LoopPartsBatch::step_tile(double* state, std::size_t size, const double* input, double offset, double* positions,
                               const ControlInputs& control) {
  detail::parts_tile(parts_, place(), size, state, input, offset, positions, control);
}

void LoopPartsBatch::output_tile(const double* state, std::size_t size, double* positions) const {
  std::copy_n(state, size, positions);
}

}  // namespace platoon
