#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/run/io/csv_text.hpp"
#include "stochastic_platoon/run/results/run_result.hpp"

namespace platoon {

/// Adds the theoretical mean and variance of a signal; empty cells if the theory does not cover the follower.
void add_signal_theory(CsvText& csv, const Prediction& prediction, std::size_t signal, std::size_t follower,
                       std::size_t cell);

/// The follower's collision_bounds(); none if the theory does not cover it.
std::optional<double> collision_bound(const Prediction& prediction, std::size_t follower);

/// The warnings of the prediction, and, where the theory has no signals, those about the measured motion.
std::vector<std::string> run_warnings(const Configuration& configuration, const Prediction& prediction,
                                      const RunResult& result);

/// The content of signals.csv: mean and variance of every requested signal for every follower and step, beside the
/// theory; its columns are empty where there is none.
std::string signals_csv(const Configuration& configuration, const Prediction& prediction, const RunResult& result);

/// The content of gaps.csv: per follower the smallest gap of all realizations with its place, the realizations with a
/// collision and with less than safe_gap, the upper bound of the probability of a collision by theory, and the
/// realizations by smallest gap. A column bin_X counts the gaps from X [m] up to the next bin; the bins of number
/// +-FollowerGaps::kMostBins are open to their side.
std::string gaps_csv(const Configuration& configuration, const Prediction& prediction, const RunResult& result);

/// The content of amplification.csv: a row per vehicle 0 .. N with the figures of amplification() over the steps from
/// burn_in on, measured and in theory. Cells are empty where there is no figure. The leader's row is the model's.
std::string amplification_csv(const Configuration& configuration, const Prediction& prediction,
                              const RunResult& result);

/// The content of limits.csv: per follower the share of its steps at the lower and upper limit of its input and of its
/// speed, over all realizations (see count_at_limits()); empty without the limit, and for inputs of external vehicles.
std::string limits_csv(const Configuration& configuration, const RunResult& result);

/// The smallest gap of all followers for summary.json: gap, vehicle, realization, step; null without gaps.
nlohmann::json smallest_gap_json(const RunResult& result);

/// Lines of the report on the signals, the amplification and the smallest gap, and the command that replays its
/// realization; empty without signals.
std::string signals_report(const Configuration& configuration, const Prediction& prediction, const RunResult& result);

}  // namespace platoon
