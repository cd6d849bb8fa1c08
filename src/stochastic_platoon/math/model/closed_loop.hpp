#pragma once

#include <complex>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/math/model/state_space.hpp"
#include "stochastic_platoon/math/model/transfer_function.hpp"

namespace platoon {

struct ExactFraction;

/// The closed loop of one vehicle (paper, section 3) and what formed it.
struct ClosedLoop {
  TransferFunction transfer;                       ///< T(z) in lowest terms
  StateSpace realization;                          ///< minimal realization A, B, C of T, eq. (ith-closedloop)
  std::vector<std::complex<double>> hidden_modes;  ///< zeros of what cancelled between N and D of T
  std::optional<int> integrators = {};             ///< poles of G K at z = 1; none where T itself was given

  /// T as plant and controller, or A, B and C, give it, where `transfer` and `realization` have the rounding of their
  /// coefficients, which a fast sampled loop magnifies. What `transfer` cancelled stands in both, but for zeros at
  /// z = 0 and where a hidden mode is unstable. Empty: that of `transfer`.
  std::shared_ptr<const ExactFraction> exact = {};
};

/// The highest order of a closed loop: T of more poles is refused.
constexpr Eigen::Index kHighestOrder = 20;

/// T by powers of z - 1, to a hundred digits (model/exact.hpp).
ExactFraction exact_fraction(const ClosedLoop& loop);

/// T by powers of z - 1.
DeltaFraction delta_fraction(const ClosedLoop& loop);

/// rho(A) of the loop as plant and controller, or A, B and C, give it; 1 - rho(A) has the digits of rho(A).
double spectral_radius(const ClosedLoop& loop);

/// |T(1) - 1| + |dT/dz(1) + h| / (1 + h): by how much the loop as it is given misses double integral action. Of
/// plant and controller it is rounding; A, B and C have it to the digits that they are written with.
double integral_defect(const ClosedLoop& loop, double headway);

/// Plant and controller of a vehicle, from which a closed loop follows for every headway.
struct LoopDesign {
  TransferFunction plant;       ///< G(z)
  TransferFunction controller;  ///< K(z), or K(z) (1 + h) where the next is true
  bool divide_by_one_plus_headway = false;
};

/// T = K G / (1 + K G H) with H = (1 + h) - h / z, in lowest terms, realized in observable canonical form.
/// Poles of plant and controller at z = 1, to the rounding of their coefficients, are taken to be there.
///
/// Throws std::invalid_argument when T is not strictly proper, when G K is zero, when T has more than
/// kHighestOrder poles, and when a coefficient of T is not finite.
ClosedLoop close_loop(const TransferFunction& plant, const TransferFunction& controller, double headway);
ClosedLoop close_loop(const LoopDesign& design, double headway);

/// The closed loop given by its own realization, which is kept as it is. Throws std::invalid_argument when it
/// has more than kHighestOrder states.
ClosedLoop closed_loop_from(const StateSpace& realization);

/// S(z) = 1 - H(z) T(z), not reduced (paper, section 3).
TransferFunction sensitivity(const TransferFunction& transfer, double headway);

/// The assumptions that the loop violates, one sentence each; none for a loop that can be run. Assumed are
/// - T strictly proper and double integral action of G K, that is S with two zeros at z = 1 (paper,
///   assumption 1 a and b),
/// - a realization in double that does the same: T(1) = 1 for the coefficients as they are rounded,
/// - rho(A) < 1 and no hidden mode outside the open unit disk, unless `allow_unstable`,
/// - an equilibrium exists, in which the vehicles start.
std::vector<std::string> violated_assumptions(const ClosedLoop& loop, double headway, bool allow_unstable);

}  // namespace platoon
