#pragma once

#include "stochastic_platoon/theory/loop_spectrum.hpp"

namespace platoon {

enum class Sign { kPositive, kZero, kNegative };

/// 1 - |T|^2 where it is least, its zero at w = 0 divided out.
struct LeastMargin {
  Sign sign;         ///< zero where rounding of T's coefficients cannot tell it from zero
  double value;      ///< of the spectrum's stripped_margin; 0 where the sign is zero
  double frequency;  ///< [rad/sample]
};

/// Over w in [0, pi], from the sign changes of the derivative and the ends: no grid.
LeastMargin least_margin(const LoopSpectrum& spectrum);

}  // namespace platoon
