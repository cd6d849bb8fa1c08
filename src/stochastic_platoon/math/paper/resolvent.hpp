#pragma once

#include <cstddef>

#include "stochastic_platoon/math/model/state_space.hpp"

namespace platoon {

/// sup_w ||R(e^{jw})||_2, from the critical points of a polynomial in cos w. Throws std::invalid_argument if rho(A) >=
/// 1.
double resolvent_peak(const StateSpace& system);

/// The energy in zeta_N per state of xi_1, ..., xi_N of a string of N = `followers`,
/// \f[ \sum_{m=0}^{N-1} \|T^m R\|_2^2. \f]
/// Throws std::invalid_argument if rho(A) >= 1 or followers < 1.
double resolvent_energy(const StateSpace& system, std::size_t followers);

}  // namespace platoon
