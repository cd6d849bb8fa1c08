#pragma once

#include <cstddef>
#include <vector>

#include "stochastic_platoon/math/model/loop_batch.hpp"
#include "stochastic_platoon/math/model/state_space.hpp"

namespace platoon {

struct LoopDesign;

/// A strictly proper fraction and its direct term by powers of s = z - 1, in observable canonical form:
/// \f[ x_j(k+1) = x_j(k) + x_{j+1}(k) - a_j x_0(k) + b_j u(k), \qquad y = x_0 + direct \: u. \f]
/// The coefficients of slow poles are small here, and those of integrators are 0: rounding does not move them.
template <class Scalar>
struct BasicDeltaFilter {
  std::vector<Scalar> a, b;
  Scalar direct = 0;

  std::size_t order() const { return a.size(); }
};

/// A vehicle as it is built: plant G behind an input delay, controller K, and their spacing policy.
///
///     e = u^ - y - s (y - y(k-1)),   c = K e + F v,   u = c or, with a headway filter, (c + h u(k-1)) / (1 + h),
///     y = G z^-delay u
///
/// with v the predecessor's input as received, if the vehicle feeds it forward by a gain F. The spacing s is the
/// headway h, unless the vehicle hears others than its predecessor (see Input). T(1) = 1 and dT/dz(1) = -s hold for any
/// rounding of the coefficients.
template <class Scalar>
struct BasicLoopParts {
  BasicDeltaFilter<Scalar> plant, controller;
  std::size_t delay = 0;  ///< of the plant's input [steps]: costs a load, no multiplication
  Scalar headway = 0, spacing = 0;
  bool headway_filter = false;

  /// States in their order: plant, controller, y(k-1), u(k-1), u(k-2) ... u(k-delay); u(k-1) is a state only with a
  /// headway filter or a delay.
  std::size_t order() const {
    const std::size_t inputs = delay > 0 ? delay : headway_filter ? 1 : 0;
    return plant.order() + controller.order() + 1 + inputs;
  }
};

using LoopParts = BasicLoopParts<double>;

/// The parts of a design, in double or long double. Throws std::invalid_argument if G is not strictly proper or K not
/// proper.
template <class Scalar>
BasicLoopParts<Scalar> loop_parts(const LoopDesign& design, double headway);

/// One step of one realization with the received position and F times the received input. Returns u(k); y = state[0].
/// In double, the order of operations is that of the batch.
template <class Scalar>
Scalar advance(const BasicLoopParts<Scalar>& parts, std::vector<Scalar>& state, Scalar position, Scalar fed_forward);

/// States of y = 1 at rest.
template <class Scalar>
std::vector<Scalar> unit_equilibrium(const BasicLoopParts<Scalar>& parts);

/// States of y(k) = k in steady motion, at k = 0.
std::vector<double> unit_ramp(const LoopParts& parts);

/// States with u(k - delay) first among the delayed inputs, as batches keep them.
std::vector<double> in_ring_order(const LoopParts& parts, std::vector<double> state);

/// A, B and C of the same loop.
StateSpace realization(const LoopParts& parts);

/// The parts of one vehicle for a batch of realizations. u(k - delay) is at place() among the delayed inputs.
class LoopPartsBatch : public LoopBatch {
public:
  explicit LoopPartsBatch(const LoopParts& parts);

private:
  void step_tile(double* state, std::size_t size, const double* input, double offset, double* positions,
                 const ControlInputs& control) override;
  void output_tile(const double* state, std::size_t size, double* positions) const override;

  LoopParts parts_;
};

}  // namespace platoon
