#pragma once

#include <string>
#include <vector>

#include "stochastic_platoon/configuration/configuration.hpp"
#include "stochastic_platoon/results/checkpoint.hpp"
#include "stochastic_platoon/statistics/agreement.hpp"
#include "stochastic_platoon/statistics/moments.hpp"
#include "stochastic_platoon/theory/error_moments.hpp"
#include "stochastic_platoon/theory/stationary_variance.hpp"
#include "stochastic_platoon/theory/string_stability.hpp"

namespace platoon {

/// What the paper predicts for a configuration. Of an endless run: the stationary values, one cell per
/// follower.
struct Prediction {
  StringStability stability;
  std::vector<double> stationary_variance;  ///< [m^2], one per follower; NaN where there is none
  std::vector<double> mean;                 ///< [m], one per cell
  std::vector<double> variance;             ///< [m^2], one per cell
};

/// `leader_positions`, y_0(-1) .. y_0(steps - 1), stand for the model's own leader where they are given.
Prediction predict(const Configuration& configuration, const std::vector<double>& leader_positions = {});

/// What was measured. Of an ensemble: a cell per follower and step (see cell()); of an endless run: one per
/// follower.
struct RunResult {
  bool complete = false;
  std::uint64_t realizations = 0;  ///< committed
  std::int64_t last_step = 0;      ///< of a time average: the latest step in it
  Tally tally;
  std::vector<Moments> moments;
};

/// Positions that the committed realizations must have brought: (N + 1)(K + 1) each.
std::uint64_t positions_expected(const RunOptions& run, std::uint64_t realizations);

/// Writes output/statistics.csv and output/summary.json, each atomically. Throws std::runtime_error.
void write_results(const Configuration& configuration, const Prediction& prediction, const RunResult& result);

/// The content of statistics.csv.
std::string statistics_csv(const Configuration& configuration, const Prediction& prediction,
                           const RunResult& result);

/// The table and the verdict for a terminal: per follower at the last step the measured variance with its
/// standard error, the theoretical variance and the score; then whether all cells agree, and whether the
/// platoon is string stable and why.
std::string report(const Configuration& configuration, const Prediction& prediction, const RunResult& result);

}  // namespace platoon
