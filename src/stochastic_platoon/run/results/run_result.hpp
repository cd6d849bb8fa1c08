#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "stochastic_platoon/math/statistics/agreement.hpp"
#include "stochastic_platoon/math/statistics/ensemble_totals.hpp"
#include "stochastic_platoon/run/configuration/configuration.hpp"
#include "stochastic_platoon/run/report/prediction.hpp"

namespace platoon {

/// Counts of a run beside the moments.
struct Tally {
  std::uint64_t positions_received = 0;  ///< in committed batches
  std::uint32_t attempts = 0;            ///< number of the latest attempt
  double wall_seconds = 0.0;             ///< from the first position to the latest commit, over all launches
  std::uint64_t platoon_time = 0;        ///< latest stamp seen [ns]
};

/// The measured values: one cell per follower and step (see cell()), or one per follower for averages over time.
struct RunResult {
  bool complete = false;
  std::uint64_t realizations = 0;  ///< committed
  std::int64_t last_step = 0;      ///< the latest step of all followers, also if averages over time leave it out
  Tally tally;
  std::vector<Moments> moments;                    ///< of the tracking errors
  std::vector<std::int64_t> last_steps;            ///< for averages over time: see ErrorAverages::last_counted()
  std::int64_t counted_from = 0;                   ///< see ErrorAverages
  bool manoeuvre = false;                          ///< the leader departs from the model at present
  std::vector<Moments> provisional = {};           ///< see ErrorAverages; for displays alone
  std::vector<IndependentShare> shares = {};       ///< for averages over time: as measured, one per follower
  std::vector<std::vector<Moments>> signals = {};  ///< of each requested signal, one cell per follower and step
  GapTable gaps = GapTable();                      ///< empty if the gap is not among them
  LimitTable limits = LimitTable();                ///< empty if no vehicle has limits
};

/// The result of a set of a run's realizations, complete if these are all.
RunResult result_of(const Configuration& configuration, const EnsembleTotals& totals, const Tally& tally = {});

/// A cell of a result with its theory: follower i and a step. An average over time has a share, by ErrorCorrelation,
/// else by BatchMeans; the fourth moment is one of fourth_moments(), infinite where the means alone are compared or
/// fewer than a thousand realizations of quantised errors measure it.
struct ResultCell : Comparison {
  std::size_t follower;
  std::int64_t step;  ///< for an average over time the latest step in it
};

/// Fourth central moment of each cell's error [m^4] if packets are lost and the theory has it; else empty. With the
/// theoretical variance v it is the larger of
///
///     3 v^2 + fourth_cumulant: the theory to first order (see linked_error_moments()), the only information if losses
///         are so rare that a run may contain none; and
///     v^2 times the measured kurtosis over all steps of the follower, which includes losses in a row.
///
/// This kurtosis approaches the number of realizations if most of a variance is due to very rare events.
std::vector<double> fourth_moments(const RunOptions& run, const Prediction& prediction, const RunResult& result);

/// The cells of a result with their theory. Keeps references to all three arguments.
class ResultCells {
public:
  ResultCells(const RunOptions& run, const Prediction& prediction, const RunResult& result);

  ResultCell of(std::size_t follower, std::int64_t step) const;

  /// The cells of a step, one per follower; for averages over time all cells, for any step.
  std::vector<ResultCell> at(std::int64_t step) const;

private:
  const RunOptions& run_;
  const Prediction& prediction_;
  const RunResult& result_;
  std::vector<double> fourth_moments_;
};

/// Standard errors of the cell's mean [m] and variance [m^2], the same in reports, summaries, sweeps and messages:
///
///     mean      sqrt(v / n),
///     variance  sqrt(2 / (n - 1)) v for normal errors, else sqrt((m_4 - v^2) / n),
///
/// with v the theoretical variance if there is a theory, else the measured one, and m_4 the cell's fourth moment;
/// without it, with the measured variance and fourth moment. Averages over time multiply n and n - 1 by the share; NaN
/// if the share is unknown. A measured share has no `expected`: it gives standard errors, but no score.
double standard_error_of_mean(const ResultCell& of);
double standard_error_of_variance(const ResultCell& of);

/// Agreement of measurement and theory. None without a theory, for fewer than two realizations (realizations_needed()
/// for errors that are not normal), or for averages over time that are worth fewer than a thousand independent errors,
/// or whose errors are not normal.
std::optional<Agreement> measured_agreement(const RunOptions& run, const Prediction& prediction,
                                            const RunResult& result);

/// The same for a requested signal over the followers and steps where the theory knows its variance: of the means alone
/// unless the signals are normal. None without such values, and for fewer than two realizations.
std::optional<Agreement> signal_agreement(const RunOptions& run, const Prediction& prediction, const RunResult& result,
                                          std::size_t signal);

/// " (largest |z| 0.51, at most 4.32)".
std::string largest_score(const Agreement& of);

/// A sentence if a follower whose variance has settled is measured above the limit of a platoon that is judged string
/// stable, and where others than predecessors are heard also above its own stationary variance; none otherwise. By
/// chance it is above by as much in at most one of 1000 runs: by the score against the limit (see scores()), else, if
/// the scatter of the variance is unknown, by Markov's inequality, P(variance > 1000 n limit) <= 1 / (1000 n) for each
/// of n followers. A rounding of a nanometre is allowed.
std::optional<std::string> measured_growth(const Configuration& configuration, const Prediction& prediction,
                                           const RunResult& result);

/// Number of realizations that measured_agreement() needs for errors that are not normal, estimated from this result:
/// from all cells' fourth moments if packets are lost (infinite if one leaves the range of double), a thousand for
/// quantised errors. None for normal errors, over time, or without a theory.
std::optional<double> realizations_needed(const RunOptions& run, const Prediction& prediction, const RunResult& result);

/// Number of cells with a theory: those of the followers before the first external vehicle.
std::size_t cells_with_theory(const RunOptions& run, const Prediction& prediction);

/// Number of positions that the committed realizations must have brought: (N + 1)(K + 1) each.
std::uint64_t positions_expected(const RunOptions& run, std::uint64_t realizations);

}  // namespace platoon
