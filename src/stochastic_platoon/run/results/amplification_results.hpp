#pragma once

#include <string>

#include "stochastic_platoon/run/results/run_result.hpp"

namespace platoon {

/// The content of amplification.csv: a row per vehicle 0 .. N with the figures of amplification() over the steps from
/// burn_in on, measured and in theory. Cells are empty where there is no figure. The leader's row is the model's.
std::string amplification_csv(const Configuration& configuration, const Prediction& prediction,
                              const RunResult& result);

/// A line of the report: the largest ratio and the ratio head to tail, or the reason why there is none.
std::string amplification_report(const Configuration& configuration, const Prediction& prediction,
                                 const RunResult& result);

}  // namespace platoon
