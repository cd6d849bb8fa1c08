#pragma once

#include <string>

#include "stochastic_platoon/run/results/run_result.hpp"

namespace platoon {

/// The content of ages.csv: a row per link that loses and per age of its information (see age_probabilities()) that
/// occurs, with its number of steps, their share, and the expected share (empty for recorded losses). Counted are the
/// messages of steps 0 .. K-2, on which the vehicles of a run act, of the first realizations: up to 10^7 in all. Losses
/// by the distance are left out. Empty without any row.
std::string ages_csv(const Configuration& configuration, const RunResult& result);

}  // namespace platoon
