#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "stochastic_platoon/run/results/run_result.hpp"

namespace platoon {

/// Whether the theory covers the signals of a follower.
bool has_signal_theory(const Prediction& prediction, std::size_t follower);

/// The content of signals.csv: mean and variance of every requested signal for every follower and step, beside the
/// theory; its columns are empty where there is none.
std::string signals_csv(const Configuration& configuration, const Prediction& prediction, const RunResult& result);

/// The content of gaps.csv: per follower the smallest gap of all realizations with its place, the realizations with a
/// collision and with less than safe_gap, the upper bound of the probability of a collision by theory, and the
/// realizations by smallest gap. A column bin_X counts the gaps from X [m] up to the next bin; the bins of number
/// +-FollowerGaps::kMostBins are open to their side.
std::string gaps_csv(const Configuration& configuration, const Prediction& prediction, const RunResult& result);

/// The smallest gap of all followers for summary.json: gap, vehicle, realization, step; null without gaps.
nlohmann::json smallest_gap_json(const RunResult& result);

/// Lines of the report on the signals, the amplification and the smallest gap, and the command that replays its
/// realization; empty without signals.
std::string signals_report(const Configuration& configuration, const Prediction& prediction, const RunResult& result);

}  // namespace platoon
