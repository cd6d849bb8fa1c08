#pragma once

#include <cstddef>
#include <vector>

#include "stochastic_platoon/model/delta_form.hpp"

namespace platoon {

/// The closed loop T of one vehicle as an operator on finite sequences, in observable canonical form by
/// powers of s = z - 1,
///     v_j(k+1) = v_j(k) + v_{j+1}(k) - d_{n-1-j} v_0(k) + c_{n-1-j} u(k), j = 0 .. n-1, v_n = 0,   y = v_0,
/// with c_j and d_j the coefficients of N and D. In extended precision: what LoopFilter does for loops whose
/// coefficients by powers of z have lost digits.
class DeltaFilter {
public:
  using Scalar = long double;
  using Sequence = std::vector<Scalar>;

  /// T must be strictly proper, its denominator's leading coefficient 1.
  explicit DeltaFilter(const DeltaFraction& transfer);

  /// y = T u from the zero state, as long as u.
  Sequence operator()(const Sequence& input) const;

  /// The free motion y(0), y(1), ... from the equilibrium with output 1.
  Sequence free_response(std::size_t count) const;

  /// y from the zero state, where the state is moved by -e moved(k), e the equilibrium of the input 1, in
  /// place of an input: y of the distance that a leader at the sum of the moves is ahead of its equilibrium.
  Sequence lag(const Sequence& moved) const;

  /// T(1).
  Scalar gain() const { return gain_; }

private:
  void advance(Sequence& state, Scalar input) const;

  Sequence numerator_;    ///< c_{n-1}, ..., c_0
  Sequence denominator_;  ///< d_{n-1}, ..., d_0
  Sequence equilibrium_;  ///< of the input 1
  Scalar gain_;
};

}  // namespace platoon
