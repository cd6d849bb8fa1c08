#pragma once

#include <complex>
#include <memory>
#include <optional>
#include <vector>

#include "stochastic_platoon/math/model/loop_design.hpp"
#include "stochastic_platoon/math/model/loop_parts.hpp"
#include "stochastic_platoon/math/model/state_space.hpp"
#include "stochastic_platoon/math/model/transfer_function.hpp"

namespace platoon {

struct ExactFraction;

/// The closed loop of one vehicle (paper, section 3) and its origin.
struct ClosedLoop {
  TransferFunction transfer;                       ///< T(z) in lowest terms
  StateSpace realization;                          ///< minimal realization A, B, C of T, eq. (ith-closedloop)
  std::vector<std::complex<double>> hidden_modes;  ///< zeros of the factor cancelled between N and D of T
  std::optional<int> integrators = {};             ///< poles of G K at z = 1; none if T itself was given

  /// T computed from plant and controller, or from A, B and C, to a hundred digits. `transfer` and `realization` have
  /// rounded coefficients, which a fast sampled loop magnifies. Factors cancelled in `transfer` remain in both
  /// polynomials here, except zeros at z = 0. Empty if T is `transfer`, which includes loops with an unstable hidden
  /// mode.
  std::shared_ptr<const ExactFraction> exact = {};

  /// Poles of T as s = z - 1, zeros and poles at z = 0 included. Empty: they follow from the coefficients.
  std::vector<std::complex<long double>> poles = {};

  /// The parts that compute the vehicle if its design is_by_parts(): `realization` is then theirs, and `transfer` is
  /// not reduced. Empty: `realization` computes the vehicle.
  std::optional<LoopParts> parts = {};

  /// The resolvent of A, B and C that were given. Empty: the loop was formed from plant and controller.
  std::shared_ptr<const Resolvent> given = {};

  /// Zeros of T as s = z - 1. Empty: they follow from the coefficients.
  std::vector<std::complex<long double>> zeros = {};
};

/// Largest number of poles of T without those of an input delay; a closed loop with more is rejected.
constexpr Eigen::Index kHighestOrder = 20;

/// T by powers of z - 1, to a hundred digits (numerics/exact.hpp).
ExactFraction exact_fraction(const ClosedLoop& loop);

/// T by powers of z - 1.
DeltaFraction delta_fraction(const ClosedLoop& loop);

/// The poles of T as s = z - 1, with those that `transfer` has cancelled; see ClosedLoop::exact.
std::vector<std::complex<long double>> poles_of(const ClosedLoop& loop);

/// The zeros of T as s = z - 1, with those that `transfer` has cancelled.
std::vector<std::complex<long double>> zeros_of(const ClosedLoop& loop);

/// The hidden modes outside the open unit disk. They are computed as zeros of polynomials, so a mode within rounding of
/// the unit circle counts as on it.
std::vector<std::complex<double>> unstable_hidden_modes(const ClosedLoop& loop);

/// rho(A) of the loop defined by plant and controller, or by A, B and C; 1 - rho(A) is as accurate as rho(A).
double spectral_radius(const ClosedLoop& loop);

/// The closed loop of plant G and controller K,
/// \f[ T = \frac{K G}{1 + K G H}, \qquad H = (1 + h) - h / z, \f]
/// in lowest terms, realized in observable canonical form. Poles of plant and controller that are at z = 1 to the
/// rounding of their coefficients are placed there exactly. A headway filter divides K by H:
/// \f$ T = K G / (H (1 + K G)) \f$. `before`: the loop of the same design at another headway; its poles that do not
/// depend on the headway are reused.
///
/// Throws std::invalid_argument if T is not strictly proper, if G K is zero, if T has more than kHighestOrder poles, or
/// if a coefficient of T is not finite.
ClosedLoop close_loop(const LoopDesign& design, double headway, const ClosedLoop* before = nullptr);

/// The closed loop given by its own realization, which is kept unchanged. `transfer` has no leading coefficients of N
/// that are zero to the rounding of the entries of A, B and C; `exact`, poles and zeros keep them as the entries give
/// them. Throws std::invalid_argument if it has more than kHighestOrder states.
ClosedLoop closed_loop_from(const StateSpace& realization);

}  // namespace platoon
