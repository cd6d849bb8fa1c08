#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "stochastic_platoon/math/model/link_model.hpp"

namespace platoon {

/// Age of information of a link: the number n of steps since the last arrival, 0 if the value of this step arrives. The
/// value of step -1 always arrives. A delay of the link adds to the age. In the stationary state of random losses,
/// independent or in bursts, with q = probability, a = after_arrival() and b = after_loss(),
/// \f[ P(0) = 1 - q, \qquad P(n) = (1 - q) a b^{n-1}. \f]
/// The mean is q times the mean burst. With the lost modes l of any LossChain, P(n) = pi_a Pi_al Pi_ll^(n-1) (1, ...,
/// 1)', and q b^n becomes pi_l Pi_ll^n (1, ..., 1)'. `loss` must have neither a trace nor losses by the distance, which
/// have no such distribution. P(0), P(1), ..., until less than 1e-12 is left, at most 100,000 of them.
std::vector<double> age_probabilities(const LossModel& loss);
double mean_age(const LossModel& loss);  ///< [steps]

/// The smallest age n that is exceeded with probability q b^n <= rest, 0 < rest < 1 [steps].
double age_exceeded_with(const LossModel& loss, double rest);

/// Expected share of age n among steps 0 .. K - 1, K = steps, with step -1 as the last arrival before the start:
/// \f[ [(K - n) P(n) + q b^{n-1}] / K, \qquad 1 \le n \le K. \f]
double expected_age_share(const LossModel& loss, std::int64_t n, std::int64_t steps);

/// Numbers of steps with age 0, 1, ... among steps 0 .. steps - 1 of `realizations` realizations from `first` on, from
/// the draws of the link with this random stream (see input_stream()). Throws std::invalid_argument for losses by the
/// distance, which depend on the run.
std::vector<std::uint64_t> count_ages(const LossModel& loss, std::uint64_t seed, std::uint32_t stream,
                                      std::uint64_t realizations, std::int64_t steps, std::uint64_t first = 0);

}  // namespace platoon
