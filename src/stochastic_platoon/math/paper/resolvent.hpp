#pragma once

#include <cstddef>

#include "stochastic_platoon/math/model/state_space.hpp"

namespace platoon {

/// sup_w ||R(e^{jw})||_2, found through the critical points of a polynomial in cos w. Throws
/// std::invalid_argument when rho(A) >= 1.
double resolvent_peak(const StateSpace& system);

/// Sum over m = 0 .. followers-1 of ||T^m R||_2^2: the energy with which the states xi_1, ..., xi_N of a
/// string show in zeta_N. Throws std::invalid_argument when rho(A) >= 1 and unless followers >= 1.
double resolvent_energy(const StateSpace& system, std::size_t followers);

}  // namespace platoon
