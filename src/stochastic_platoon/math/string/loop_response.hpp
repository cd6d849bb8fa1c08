#pragma once

#include <cstddef>
#include <vector>

#include "stochastic_platoon/math/model/closed_loop.hpp"

namespace platoon {

/// The closed loop T = N / D of one vehicle as an operator on finite sequences, in extended precision.
///
/// T is realized in observable canonical form in Newton's basis phi_0 = 1, phi_{j+1} = (z - lambda_j) phi_j; the first
/// nodes lambda are 1 and the last are 0:
///
///     v_j(k+1) = lambda_{n-1-j} v_j(k) + v_{j+1}(k) - d_{n-1-j} v_0(k) + c_{n-1-j} u(k),  j = 0 .. n-1,  v_n = 0,
///     y = v_0,   with N = sum c_j phi_j and D = phi_n + sum d_j phi_j.
///
/// Slow poles cancel in powers of z, and the poles of a delay in powers of z - 1. All nodes are 1 if the terms are at
/// most 100 times D on the unit circle; otherwise the number of nodes at 1 minimizes the terms relative to D.
class LoopResponse {
public:
  using Sequence = std::vector<long double>;

  /// Smaller states count as zero: arithmetic with subnormal numbers is a hundred times slower.
  static constexpr long double kNegligibleState = 1e-290L;

  /// T must be strictly proper.
  explicit LoopResponse(const ClosedLoop& loop);

  /// y = T u from the zero state, same length as u.
  Sequence operator()(const Sequence& input) const;

  /// The free motion y(0), y(1), ... from the equilibrium with output 1.
  Sequence free_response(std::size_t count) const;

private:
  void advance(Sequence& state, long double input) const;

  std::size_t at_zero_;   ///< number of nodes at 0, which belong to the first states
  Sequence numerator_;    ///< c_{n-1}, ..., c_0
  Sequence denominator_;  ///< d_{n-1}, ..., d_0
  Sequence equilibrium_;  ///< with output 1
};

}  // namespace platoon
