#pragma once

#include <array>
#include <cstddef>

#include "stochastic_platoon/math/model/loop_parts.hpp"
#include "stochastic_platoon/math/numerics/aligned_values.hpp"
#include "stochastic_platoon/math/numerics/vector_clones.hpp"

/// One step of a vehicle by parts for the realizations of a tile, with or without limits.
namespace platoon::detail {

constexpr std::size_t kPartLanes = 32;  ///< realizations per pass

/// x_j += x_{j+1} - a_j y + b_j u, state by state.
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

/// The plant of LoopParts.
struct FilteredPlant {
  const BasicDeltaFilter<double>& filter;

  std::size_t order() const { return filter.order(); }
  PLATOON_INLINE void advance(std::size_t lanes, const double* y, const double* u, double* state) const {
    advance_filter(filter, lanes, y, u, state);
  }
};

/// Limits that do not exist.
struct Unlimited {
  PLATOON_INLINE void clip(const LoopParts&, std::size_t, double*, double*) const {}
};

/// Plant: as FilteredPlant. Limits: clip(parts, lanes, u, states of the controller).
template <class Plant, class Limits>
PLATOON_INLINE void parts_lanes(const LoopParts& parts, const Plant& plant, const Limits& limits, std::size_t place,
                                std::size_t lanes, double* state, const double* input, double offset, double* positions,
                                const ControlInputs& control) {
  std::array<double, kPartLanes> y, e, u, first;
  double* const controller = state + plant.order() * kTile;
  double* const before = controller + parts.controller.order() * kTile;
  double* const inputs = before + kTile;  // with a headway filter and no delay, u(k-1) alone
  for (std::size_t r = 0; r < lanes; ++r) {
    y[r] = state[r];
    e[r] = input[r] - offset - y[r] - parts.spacing * (y[r] - before[r]);
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
  limits.clip(parts, lanes, u.data(), controller);
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
  plant.advance(lanes, y.data(), u.data(), state);
  for (std::size_t r = 0; r < lanes; ++r) positions[r] = state[r];
}

/// The same for all realizations of a tile.
template <class Plant, class Limits>
PLATOON_INLINE void step_lanes(const LoopParts& parts, const Plant& plant, const Limits& limits, std::size_t place,
                               std::size_t size, double* state, const double* input, double offset, double* positions,
                               const ControlInputs& control) {
  std::size_t r = 0;
  for (; r + kPartLanes <= size; r += kPartLanes)
    parts_lanes(parts, plant, limits, place, kPartLanes, state + r, input + r, offset, positions + r, control.from(r));
  parts_lanes(parts, plant, limits, place, size - r, state + r, input + r, offset, positions + r, control.from(r));
}

}  // namespace platoon::detail
