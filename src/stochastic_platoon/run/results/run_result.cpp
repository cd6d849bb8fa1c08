#include "stochastic_platoon/run/results/run_result.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "stochastic_platoon/math/numerics/interruption.hpp"
#include "stochastic_platoon/math/numerics/special_values.hpp"
#include "stochastic_platoon/math/numerics/text.hpp"
#include "stochastic_platoon/math/string/contradictions.hpp"

namespace platoon {

namespace {

// Number of realizations from which the means and variances of non-normal errors are themselves normal, and number of
// independent errors that an average over time must be worth for asymptotic results to hold.
constexpr std::uint64_t kEnoughForAnyDistribution = 1000;

// The share of a follower's average over time: that of the theory, in which each attempt is one stretch, else the
// measured one. Unknown while the transient of the start decays.
IndependentShare share_of(const Prediction& prediction, const RunResult& result, std::size_t follower) {
  const std::vector<ErrorCorrelation>& known = prediction.error_correlation;
  if (follower <= known.size() && known[follower - 1].length() > 0) {
    return known[follower - 1].of(result.moments[follower - 1].count,
                                  std::max<std::uint64_t>(result.tally.attempts, 1));
  }
  if (!result.shares.empty() && prediction.warning.empty()) return result.shares[follower - 1];
  return {kNaN, kNaN, kNaN};
}

// Whether values that are not normal are too few for their measured fourth moment to tell how their variance scatters.
bool has_unknown_scatter(const Moments& of) {
  return !std::isnan(of.fourth_deviations) && of.count < kEnoughForAnyDistribution;
}

}  // namespace

RunResult result_of(const Configuration& configuration, const EnsembleTotals& totals, const Tally& tally) {
  RunResult result;
  result.realizations = totals.count();
  result.complete = result.realizations == configuration.run.realizations;
  result.last_step = configuration.run.steps - 1;
  result.tally = tally;
  result.gaps = totals.gaps;
  result.limits = totals.limits;
  const SignalCells cells = cells_of(configuration);
  const std::vector<Moments> all = totals.moments.totals();
  const auto of_kind = [&](std::size_t kind) {
    const auto first = all.begin() + static_cast<std::ptrdiff_t>(kind * cells.of_one_kind());
    return std::vector<Moments>(first, first + static_cast<std::ptrdiff_t>(cells.of_one_kind()));
  };
  result.moments = of_kind(0);
  for (std::size_t kind = 1; kind < cells.kinds(); ++kind) result.signals.push_back(of_kind(kind));
  return result;
}

std::vector<double> fourth_moments(const RunOptions& run, const Prediction& prediction, const RunResult& result) {
  if (prediction.fourth_cumulant.empty() || result.moments.empty()) return {};
  const auto steps = static_cast<std::size_t>(run.steps);
  std::vector<double> moments;
  for (std::size_t row = 0; row < result.moments.size(); row += steps) {
    double fourth = 0.0, square_of_variance = 0.0;
    for (std::size_t c = row; c < row + steps; ++c) {
      const Moments& of = result.moments[c];
      if (of.count == 0 || std::isnan(of.fourth_deviations)) continue;
      const auto n = static_cast<double>(of.count);
      fourth += of.fourth_deviations / n;
      square_of_variance += (of.squared_deviations / n) * (of.squared_deviations / n);
    }
    const double kurtosis = fourth / square_of_variance;
    for (std::size_t c = row; c < row + steps; ++c) {
      const double square = prediction.variance[c] * prediction.variance[c];
      const double first_order = 3.0 * square + prediction.fourth_cumulant[c];
      moments.push_back(kurtosis * square > first_order ? kurtosis * square : first_order);  // also for a NaN
    }
  }
  return moments;
}

ResultCells::ResultCells(const RunOptions& run, const Prediction& prediction, const RunResult& result)
    : run_(run), prediction_(prediction), result_(result), fourth_moments_(fourth_moments(run, prediction, result)) {}

ResultCell ResultCells::of(std::size_t follower, std::int64_t step) const {
  check_interruption();
  const bool over_time = run_.averaging() == Averaging::over_time;
  const std::size_t c = over_time ? follower - 1 : cell(follower, step, run_.steps);
  // The averages of a stopped run do not all end at the same step.
  return {{result_.moments[c], prediction_.mean[c], prediction_.variance[c],
           prediction_.rounding.empty() ? 0.0 : prediction_.rounding[c],
           over_time ? share_of(prediction_, result_, follower) : IndependentShare{},
           !fourth_moments_.empty()                                            ? fourth_moments_[c]
           : prediction_.means_only || has_unknown_scatter(result_.moments[c]) ? kInfinity
                                                                               : kNaN},
          follower,
          over_time ? result_.last_steps[c] : step};
}

std::vector<ResultCell> ResultCells::at(std::int64_t step) const {
  std::vector<ResultCell> cells;
  for (std::size_t i = 1; i <= run_.followers; ++i) cells.push_back(of(i, step));
  return cells;
}

namespace {

double known_variance(const ResultCell& of) {
  return std::isnan(of.theoretical_variance) ? of.measured.variance() : of.theoretical_variance;
}

}  // namespace

double standard_error_of_mean(const ResultCell& of) {
  return standard_error_of_mean(known_variance(of), of.measured.count, of.share.mean);
}

double standard_error_of_variance(const ResultCell& of) {
  if (std::isfinite(of.fourth_moment)) {
    const double v = of.theoretical_variance;
    return std::sqrt((of.fourth_moment - v * v) / static_cast<double>(of.measured.count));
  }
  return std::isnan(of.measured.fourth_deviations)
             ? standard_error_of_variance(known_variance(of), of.measured.count, of.share.variance)
             : standard_error_of_variance(of.measured);
}

namespace {

// Whether an average over time is worth enough independent errors, and their share is that of the theory.
bool has_score_over_time(const ResultCell& of) {
  const double worth = static_cast<double>(of.measured.count) * std::min(of.share.mean, of.share.variance);
  return worth >= static_cast<double>(kEnoughForAnyDistribution) && !std::isnan(of.share.expected);
}

// Whether one of so many cells is above this bound of its variance, by what chance does in at most one of 1000 runs.
bool is_above(double bound, ResultCell of, std::size_t cells, bool is_normal, bool over_time) {
  constexpr double kRounding = 1e-9;  // [m]
  const double scale = bound / of.theoretical_variance;
  of.theoretical_variance = bound;
  of.fourth_moment *= scale * scale;
  of.rounding = std::max(of.rounding, kRounding);
  if (std::isnan(of.share.expected)) of.share.expected = 1.0;  // of a measured share
  if (over_time ? is_normal && has_score_over_time(of) : is_normal || std::isfinite(of.fourth_moment))
    return scores(of).variance > (is_normal ? largest_plausible_score(cells) : plausible_score_of_any(cells));
  // A few errors may carry a variance of unknown scatter: Markov's inequality holds for any.
  const double beyond = std::sqrt(of.measured.variance()) - of.rounding;
  return beyond > 0.0 && beyond * beyond > 1000.0 * static_cast<double>(cells) * bound;
}

}  // namespace

std::optional<Agreement> measured_agreement(const RunOptions& run, const Prediction& prediction,
                                            const RunResult& result) {
  if (!prediction.has_theory() || result.moments.empty()) return std::nullopt;
  if (!prediction.warning.empty() && !prediction.means_only) return std::nullopt;
  const bool over_time = run.averaging() == Averaging::over_time;
  const double needed = realizations_needed(run, prediction, result).value_or(2.0);
  if (!over_time && static_cast<double>(result.realizations) < std::max(needed, 2.0)) return std::nullopt;
  const ResultCells cells(run, prediction, result);
  LargestScores scores;
  for (std::size_t i = 1; i <= prediction.followers_with_theory; ++i) {
    for (std::int64_t k = 0; k < (over_time ? 1 : run.steps); ++k) {
      const ResultCell of = cells.of(i, k);
      if (over_time && !has_score_over_time(of)) return std::nullopt;
      scores.add(of);
    }
  }
  return scores.agreement();
}

std::optional<Agreement> signal_agreement(const RunOptions& run, const Prediction& prediction, const RunResult& result,
                                          std::size_t signal) {
  if (prediction.signals.empty() || result.signals.empty() || result.realizations < 2) return std::nullopt;
  const SignalMoments& theory = prediction.signals[signal];
  LargestScores scores;
  bool any = false;
  for (std::size_t c = 0; c < cells_with_theory(run, prediction); ++c) {
    if (std::isnan(theory.variance[c])) continue;  // too few digits
    any = true;
    const Comparison of{result.signals[signal][c], theory.mean[c], theory.variance[c],
                        prediction.signal_rounding[signal]};
    prediction.normal ? scores.add(of) : scores.add_mean(of);
  }
  return any ? std::optional(scores.agreement()) : std::nullopt;
}

std::string largest_score(const Agreement& of) {
  return formatted(" (largest |z| %.2f, at most %.2f)", of.largest(), of.plausible_z);
}

std::optional<std::string> measured_growth(const Configuration& configuration, const Prediction& prediction,
                                           const RunResult& result) {
  const RunOptions& run = configuration.run;
  const std::optional<double> limit = prediction.stability.limit_variance;
  if (!limit || result.moments.empty()) return std::nullopt;
  const bool over_time = run.averaging() == Averaging::over_time;
  if (over_time && !prediction.warning.empty()) return std::nullopt;
  const std::size_t known = prediction.followers_with_theory,
                    settled = over_time ? known : settled_followers(configuration.model, known, run.steps);
  const bool rises = hears_predecessors_only(configuration.model);  // else the first followers may exceed the limit
  const ResultCells cells(run, prediction, result);
  for (std::size_t i = 1; i <= settled; ++i) {
    const ResultCell of = cells.of(i, run.steps - 1);
    const double bound = rises ? *limit : std::max(*limit, prediction.stationary_variance[i - 1]);
    if (!is_above(bound, of, settled, prediction.normal, over_time)) continue;
    return formatted(
        "the measured variance of follower %zu is %.6g m^2, but the platoon is judged string stable with a limit of %.6g m^2; chance explains it in at most one of 1000 runs",
        i, of.measured.variance(), *limit);
  }
  return std::nullopt;
}

std::optional<double> realizations_needed(const RunOptions& run, const Prediction& prediction,
                                          const RunResult& result) {
  if (!prediction.has_theory() || !prediction.warning.empty() || run.averaging() == Averaging::over_time)
    return std::nullopt;
  const std::vector<double> fourth = fourth_moments(run, prediction, result);
  if (fourth.empty()) {
    const bool normal = result.moments.empty() || std::isnan(result.moments.front().fourth_deviations);
    if (normal) return std::nullopt;
    return static_cast<double>(kEnoughForAnyDistribution);
  }
  const std::size_t judged = std::min(cells_with_theory(run, prediction), fourth.size());
  double needed = 2.0;
  for (std::size_t c = 0; c < judged; ++c) {
    if (std::isinf(fourth[c]) && std::isfinite(prediction.variance[c] * prediction.variance[c])) continue;
    needed = std::max(needed, values_needed(prediction.variance[c], fourth[c], 2 * judged));
  }
  return needed;
}

std::size_t cells_with_theory(const RunOptions& run, const Prediction& prediction) {
  return prediction.followers_with_theory *
         (run.averaging() == Averaging::over_time ? 1 : static_cast<std::size_t>(run.steps));
}

std::uint64_t positions_expected(const RunOptions& run, std::uint64_t realizations) {
  return (run.followers + 1) * static_cast<std::uint64_t>(run.steps + 1) * realizations;
}

}  // namespace platoon
