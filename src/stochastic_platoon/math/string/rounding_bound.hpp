#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "stochastic_platoon/math/string/error_moments.hpp"

namespace platoon {

/// What the arithmetic in double of a vehicle may change a position of 1 m by in so many steps [m]: with u
/// the unit roundoff, e the unit equilibrium and e_j the unit vectors,
///     u sum_j [(n + 6) (|A| |e| + |B|) + |A e + B - e| / u]_j sum_{l < steps} |C A^l e_j|,
/// as each step rounds the terms of A x + B u and the coefficients are rounded themselves, which leaves T(1)
/// off 1 and e not quite in equilibrium with the input 1. Throws std::invalid_argument when the loop has no
/// equilibrium.
double rounding_bound_of_a_metre(const StateSpace& vehicle, std::size_t steps);

/// What the arithmetic in double of vehicles and channels may change a tracking error by [m], per cell of
/// `moments`, which are the model's. The first order bound
///     u [4 (1 + 2h) M + E_H + E (1 + sqrt(i (k+1)) sigma_i(k))],
/// u the unit roundoff, M(k) the largest position so far [m], E(k) = M rounding_bound_of_a_metre(k) / u and
/// E_H the same with H (1 + h - h/z) applied to the responses; sigma_i(k)^2 the variance per unit of noise
/// variance, which bounds what the errors of the positions ahead do, by Cauchy and Schwarz. Over other links the
/// largest of its vehicles' own platoons, times 1 + |c_1| + |c_2| + ... of a predictor.
std::vector<double> rounding_bounds(const PlatoonModel& model, const ErrorMoments& moments);

}  // namespace platoon
