#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "stochastic_platoon/math/model/link_model.hpp"

namespace platoon {

/// Age of information of a link: the number n of steps since the last arrival, 0 if the value of this step arrives.
/// Step -1 always does. A delay of the link comes on top. Random losses, independent or in bursts, have in their
/// stationary state, with q = probability, a = after_arrival() and b = after_loss(),
/// \f[ P(0) = 1 - q, \qquad P(n) = (1 - q) a b^{n-1}. \f]
/// The mean is q times the mean burst. Losses by a trace or by the distance have no such distribution: `loss` must have
/// neither.
std::vector<double> age_probabilities(const LossModel& loss);  ///< P(0), P(1), ..., until less than 1e-12 is left
double mean_age(const LossModel& loss);                        ///< [steps]

/// Expected share of age n among steps 0 .. K - 1, K = steps, as a loss since the start dates back to step -1:
/// \f[ [(K - n) P(n) + q b^{n-1}] / K, \qquad 1 \le n \le K. \f]
double expected_age_share(const LossModel& loss, std::int64_t n, std::int64_t steps);

/// Numbers of steps 0 .. steps - 1 of realizations 0 .. realizations - 1 with age 0, 1, ..., from the draws of the link
/// of this receiver. Losses by the distance throw std::invalid_argument: they depend on the run.
std::vector<std::uint64_t> count_ages(const LossModel& loss, std::uint64_t seed, std::uint32_t receiver,
                                      std::uint64_t realizations, std::int64_t steps);

}  // namespace platoon
