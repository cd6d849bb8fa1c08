#pragma once

#include <cstddef>
#include <vector>

#include "stochastic_platoon/model/polynomial.hpp"
#include "stochastic_platoon/model/state_space.hpp"

namespace platoon {

/// R(z) = C (zI - A)^-1, 1 x n: how the states of one vehicle show in its output.
struct Resolvent {
  std::vector<Polynomial> numerators;  ///< of the n entries, the entries of C adj(zI - A)
  Polynomial denominator;              ///< det(zI - A)
};

/// By the Faddeev-LeVerrier recursion.
Resolvent resolvent(const StateSpace& system);

/// sup_w ||R(e^{jw})||_2, found through the critical points of a polynomial in cos w. Throws
/// std::invalid_argument when rho(A) >= 1.
double resolvent_peak(const StateSpace& system);

/// Sum over m = 0 .. followers-1 of ||T^m R||_2^2: the energy with which the states xi_1, ..., xi_N of a
/// string show in zeta_N. Throws std::invalid_argument when rho(A) >= 1 and unless followers >= 1.
double resolvent_energy(const StateSpace& system, std::size_t followers);

}  // namespace platoon
