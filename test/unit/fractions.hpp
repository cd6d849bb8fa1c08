#pragma once

#include "stochastic_platoon/math/model/state_space.hpp"

namespace platoon {

/// T = C (zI - A)^-1 B, not reduced.
inline TransferFunction transfer_of(const StateSpace& system) {
  const Resolvent r = resolvent(system);
  return {r.transfer_numerator, r.denominator};
}

/// S = 1 - H T, not reduced (paper, section 3).
inline TransferFunction sensitivity(const TransferFunction& transfer, double headway) {
  const TransferFunction ht = series(headway_policy(headway), transfer);
  return {add(ht.denominator(), -ht.numerator()), ht.denominator()};
}

}  // namespace platoon
