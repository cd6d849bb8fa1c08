#pragma once

#include <cstdint>
#include <vector>

#include "stochastic_platoon/math/model/platoon_model.hpp"

namespace platoon {

/// The probability that the control input that leads to a step, u_i(k-1), of the same cars without limits is beyond the
/// limits of the input: P(u < lower) + P(u > upper) with its exact normal distribution (see without_limits() and
/// signal_moments()); one cell per follower and step, see cell(). NaN for a follower without limits of its input.
///
/// Throws std::invalid_argument as signal_moments() does for that linear platoon, and unless its errors are normal.
std::vector<double> probability_beyond_limits(const PlatoonModel& model, std::size_t followers, std::int64_t steps);

}  // namespace platoon
