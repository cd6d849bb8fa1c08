#pragma once

#include <string>

#include "stochastic_platoon/run/results/run_result.hpp"

namespace platoon {

/// The content of ages.csv; empty if it has no rows. A row holds, for one link with losses and one age of its
/// information that occurs (see age_probabilities()), the number of steps, their share, and the expected share (empty
/// for recorded losses). It counts the messages of steps 0 .. K-2, on which the vehicles of a run act, of the first
/// realizations, up to 10^7 in all; in an endless run of its latest attempt. Links whose losses depend on the distance
/// are left out.
std::string ages_csv(const Configuration& configuration, const RunResult& result);

}  // namespace platoon
