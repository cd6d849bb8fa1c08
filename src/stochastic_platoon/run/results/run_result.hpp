#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/math/statistics/agreement.hpp"
#include "stochastic_platoon/math/statistics/moments.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"
#include "stochastic_platoon/run/report/prediction.hpp"

namespace platoon {

/// What has been counted of a run, beside the moments.
struct Tally {
  std::uint64_t positions_received = 0;  ///< in committed batches
  std::uint32_t attempts = 0;            ///< number of the latest attempt
  double wall_seconds = 0.0;             ///< from the first position to the latest commit, over all launches
  std::uint64_t platoon_time = 0;        ///< latest stamp seen [ns]
};

/// What was measured: a cell per follower and step (see cell()), or of averages over time one per follower.
struct RunResult {
  bool complete = false;
  std::uint64_t realizations = 0;  ///< committed
  std::int64_t last_step = 0;      ///< the latest step in the figures
  Tally tally;
  std::vector<Moments> moments;
  std::vector<std::int64_t> last_steps;  ///< of averages over time: the latest step of each follower
};

/// A cell of a result: follower i and the step that its figures are of.
struct ResultCell {
  std::size_t follower;
  std::int64_t step;  ///< of an average over time its latest step
  Moments measured;
  double theoretical_mean;      ///< [m]
  double theoretical_variance;  ///< [m^2]
  double rounding = 0.0;        ///< [m], what the run's arithmetic may change an error by
  IndependentShare share = {};  ///< of an average over time: see ErrorCorrelation; NaN where it is not known
  double fourth_moment = std::numeric_limits<double>::quiet_NaN();  ///< [m^4]: see fourth_moments()
};

/// The fourth moment of each cell's error, about its mean [m^4], where packets are lost and the theory has it; else
/// empty. The larger of two: what the theory knows to first order (see linked_error_moments()), all there is where
/// losses are so rare that a run may not have met one; and v^2 times the kurtosis that was measured, of all steps of
/// the follower together, which has what losses in a row do. That kurtosis nears the number of realizations where most
/// of a variance is due to what hardly ever happens.
std::vector<double> fourth_moments(const RunOptions& run, const Prediction& prediction, const RunResult& result);

/// The cells of a result beside their theory; refers to all three.
class ResultCells {
public:
  ResultCells(const RunOptions& run, const Prediction& prediction, const RunResult& result);

  /// Those of a step, one per follower; of averages over time, whatever the step, all there are.
  std::vector<ResultCell> at(std::int64_t step) const;

private:
  const RunOptions& run_;
  const Prediction& prediction_;
  const RunResult& result_;
  std::vector<double> fourth_moments_;
};

/// Standard errors of the cell's mean [m] and variance [m^2], everywhere the same: in reports, summaries, sweeps and
/// messages. v is the theoretical variance where there is a theory, else the measured one. Mean: sqrt(v / n). Variance:
/// of normal errors sqrt(2 / (n - 1)) v, of others sqrt((m_4 - v^2) / n) by the cell's fourth moment, else by the
/// measured variance and fourth moment. Averages over time count n and n - 1 times the share; NaN where that is
/// unknown.
double standard_error_of_mean(const ResultCell& of);
double standard_error_of_variance(const ResultCell& of);

/// How far measurement and theory are apart. None where it cannot be said: no theory, fewer than two realizations
/// (of errors that are not normal realizations_needed()), or averages over time that are worth fewer than a thousand
/// independent errors, or are not normal.
std::optional<Agreement> measured_agreement(const RunOptions& run, const Prediction& prediction,
                                            const RunResult& result);

/// How many realizations it takes until that can be said of errors that are not normal, as far as is known by now: by
/// all cells' fourth moments where packets are lost (infinite where one leaves the range of double), a thousand of
/// errors that are quantised. None of normal errors, over time, or without a theory.
std::optional<double> realizations_needed(const RunOptions& run, const Prediction& prediction, const RunResult& result);

/// How many cells have a theory: those of the followers before the first external vehicle.
std::size_t cells_with_theory(const RunOptions& run, const Prediction& prediction);

/// Positions that the committed realizations must have brought: (N + 1)(K + 1) each.
std::uint64_t positions_expected(const RunOptions& run, std::uint64_t realizations);

/// Writes output/statistics.csv and output/summary.json, each atomically. The summary's "crc32" holds the
/// checksum() of both, its own that of its text with "00000000" in its place: who reads them recognizes damage. Throws
/// std::runtime_error.
void write_results(const Configuration& configuration, const Prediction& prediction, const RunResult& result);

/// The content of statistics.csv.
std::string statistics_csv(const Configuration& configuration, const Prediction& prediction, const RunResult& result);

}  // namespace platoon
