#pragma once

#include "stochastic_platoon/math/model/transfer_function.hpp"

namespace platoon {

/// S = 1 - H T, not reduced (paper, section 3).
inline TransferFunction sensitivity(const TransferFunction& transfer, double headway) {
  const TransferFunction ht = series(headway_policy(headway), transfer);
  return {add(ht.denominator(), -ht.numerator()), ht.denominator()};
}

}  // namespace platoon
