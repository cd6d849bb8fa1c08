#pragma once

#include <cstdint>
#include <vector>

#include "stochastic_platoon/math/model/signal.hpp"
#include "stochastic_platoon/math/statistics/batch_moments.hpp"

namespace platoon {

/// Forms signals of one follower at one step of a batch and reduces each as reduce_batch() does, with the same bits; up
/// to four at once, in half the time. `first_values`, if not null, receives the values of the first signal.
std::vector<std::vector<MomentNode>> reduce_signals(std::uint64_t first_realization, const std::vector<Signal>& signals,
                                                    const SignalPositions& positions, KeptMoments kept,
                                                    double* first_values = nullptr);

}  // namespace platoon
