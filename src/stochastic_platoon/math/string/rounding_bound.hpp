#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "stochastic_platoon/math/string/error_moments.hpp"

namespace platoon {

struct Signal;

/// Bound of the rounding error of a vehicle's arithmetic in double for a position of 1 m after `steps` steps [m]. With
/// u the unit roundoff, e the unit equilibrium and e_j the unit vectors:
///
///     u sum_j [(n + 6) (|A| |e| + |B|) + |A e + B - e| / u]_j sum_{l < steps} |C A^l e_j|.
///
/// Each step rounds the terms of A x + B u. The coefficients are rounded as well, so T(1) differs from 1 and e is not
/// quite in equilibrium with the input 1. Throws std::invalid_argument if the loop has no equilibrium.
double rounding_bound_of_a_metre(const StateSpace& vehicle, std::size_t steps);

/// Bound of the rounding error of a tracking error [m] by the arithmetic in double of vehicles and channels, per cell
/// of `moments`, which belong to the model. To first order
/// \f[ u [4 (1 + 2h) M + E_H + E (1 + \sqrt{i (k+1)} \sigma_i(k))], \f]
/// with u the unit roundoff, M(k) the largest position so far [m], E(k) = M rounding_bound_of_a_metre(k) / u and E_H
/// the same with H (1 + h - h/z) applied to the responses. sigma_i(k)^2 is the variance per unit of noise variance; by
/// Cauchy and Schwarz it bounds the effect of the errors of the positions ahead. Over other links: the largest bound
/// among the homogeneous platoons of its vehicles, times 1 + |c_1| + |c_2| + ... of a predictor.
std::vector<double> rounding_bounds(const PlatoonModel& model, const SignalMoments& moments);

/// Tolerance for the values of a signal, in its unit, by the rounding of a run and of the theory, which form it from
/// positions: 1e-11 of the largest position times the sum of the moduli of its weights; for a control input those of an
/// acceleration.
double signal_rounding(const PlatoonModel& model, const Signal& signal, std::size_t followers, std::size_t steps);

}  // namespace platoon
