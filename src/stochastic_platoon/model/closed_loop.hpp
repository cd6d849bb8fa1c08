#pragma once

#include <complex>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/model/state_space.hpp"
#include "stochastic_platoon/model/transfer_function.hpp"

namespace platoon {

/// The closed loop of one vehicle (paper, section 3) and what formed it.
struct ClosedLoop {
  TransferFunction transfer;                       ///< T(z) in lowest terms
  StateSpace realization;                          ///< minimal realization A, B, C of T, eq. (ith-closedloop)
  std::vector<std::complex<double>> hidden_modes;  ///< zeros of what cancelled between N and D of T
  std::optional<int> integrators = {};             ///< poles of G K at z = 1; none where T itself was given
};

/// Plant and controller of a vehicle, from which a closed loop follows for every headway.
struct LoopDesign {
  TransferFunction plant;       ///< G(z)
  TransferFunction controller;  ///< K(z), or K(z) (1 + h) where the next is true
  bool divide_by_one_plus_headway = false;
};

/// T = K G / (1 + K G H) with H = (1 + h) - h / z, in lowest terms, realized in observable canonical form.
/// Throws std::invalid_argument when T is not strictly proper.
ClosedLoop close_loop(const TransferFunction& plant, const TransferFunction& controller, double headway);
ClosedLoop close_loop(const LoopDesign& design, double headway);

/// The closed loop given by its own realization, which is kept as it is.
ClosedLoop closed_loop_from(const StateSpace& realization);

/// S(z) = 1 - H(z) T(z), not reduced (paper, section 3).
TransferFunction sensitivity(const TransferFunction& transfer, double headway);

/// The assumptions that the loop violates, one sentence each; none for a loop that can be run. Assumed are
/// - T strictly proper and double integral action of G K, that is S with two zeros at z = 1 (paper,
///   assumption 1 a and b),
/// - rho(A) < 1 and no hidden mode outside the open unit disk, unless `allow_unstable`,
/// - an equilibrium exists, in which the vehicles start.
std::vector<std::string> violated_assumptions(const ClosedLoop& loop, double headway, bool allow_unstable);

}  // namespace platoon
