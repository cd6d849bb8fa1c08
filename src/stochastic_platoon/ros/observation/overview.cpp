#include "stochastic_platoon/ros/observation/overview.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "stochastic_platoon/ros/messages/position.hpp"

namespace platoon {

using stochastic_platoon::Overview;

namespace {

constexpr std::size_t kMostColumns = 100;
constexpr std::size_t kMostCells = 20000;  // of a message: 640 kB
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// A result and its prediction as if the run had only some of its steps.
struct Columns {
  RunOptions run;
  Prediction prediction;
  RunResult result;
  std::vector<std::int64_t> steps;
};

Columns columns_of(const RunOptions& run, const Prediction& prediction, const RunResult& result) {
  if (run.averaging() == Averaging::over_time) {
    Columns all{run, prediction, result, {result.last_step}};
    all.result.moments.resize(run.followers);
    all.result.last_steps.resize(run.followers);
    return all;
  }
  const std::size_t most = std::clamp<std::size_t>(kMostCells / run.followers, 2, kMostColumns);
  Columns columns{run, prediction, {}, {}};
  for (std::vector<double>* cells : {&columns.prediction.mean, &columns.prediction.variance,
                                     &columns.prediction.rounding, &columns.prediction.fourth_cumulant})
    cells->clear();
  columns.steps = spread_steps(run.steps, static_cast<std::int64_t>(most));
  columns.run.steps = static_cast<std::int64_t>(columns.steps.size());
  columns.result.realizations = result.realizations;
  for (std::size_t i = 1; i <= run.followers; ++i) {
    for (const std::int64_t k : columns.steps) {
      const std::size_t c = cell(i, k, run.steps);
      columns.result.moments.push_back(result.moments.empty() ? Moments{} : result.moments[c]);
      columns.prediction.mean.push_back(prediction.mean[c]);
      columns.prediction.variance.push_back(prediction.variance[c]);
      if (!prediction.rounding.empty()) columns.prediction.rounding.push_back(prediction.rounding[c]);
      if (!prediction.fourth_cumulant.empty())
        columns.prediction.fourth_cumulant.push_back(prediction.fourth_cumulant[c]);
    }
  }
  return columns;
}

void add_verdict(const Prediction& prediction, Overview& message) {
  message.theory = name_of_theory(prediction.has_theory());
  message.string_stable = prediction.stability.string_stable;
  message.undecided = prediction.stability.undecided;
  message.reason = prediction.stability.reason + (prediction.warning.empty() ? "" : "; " + prediction.warning);
  message.warnings = prediction.warnings;
  message.limit_variance = prediction.stability.limit_variance.value_or(kNone);
  message.stationary_variance = prediction.stationary_variance;
}

void add_cells(const Columns& columns, Overview& message) {
  const std::size_t width = columns.steps.size(), cells = columns.run.followers * width;
  message.step = columns.steps;
  for (auto* values : {&message.mean, &message.variance, &message.theoretical_mean, &message.theoretical_variance})
    values->resize(cells);
  const ResultCells of_step(columns.run, columns.prediction, columns.result);
  for (std::size_t j = 0; j < width; ++j) {
    const bool last = j + 1 == width;
    for (const ResultCell& of : of_step.at(static_cast<std::int64_t>(j))) {
      const std::size_t at = (of.follower - 1) * width + j;
      message.mean[at] = of.measured.count > 0 ? of.measured.mean : kNone;
      message.variance[at] = of.measured.variance();
      message.theoretical_mean[at] = of.theoretical_mean;
      message.theoretical_variance[at] = of.theoretical_variance;
      if (!last) continue;
      message.standard_error.push_back(standard_error_of_variance(of));
      message.variance_score.push_back(scores(of).variance);
    }
  }
}

void add_provisional(const RunResult& result, Overview& message) {
  for (const Moments& of : result.provisional) {
    message.provisional_mean.push_back(of.known_mean());
    message.provisional_variance.push_back(of.variance());
  }
}

void add_gaps(const Prediction& prediction, const RunResult& result, Overview& message) {
  if (result.gaps.empty() || result.realizations == 0) return;
  for (const FollowerGaps& of : result.gaps.followers()) {
    message.smallest_gap.push_back(of.smallest.gap);
    message.smallest_gap_realization.push_back(of.smallest.realization);
    message.smallest_gap_step.push_back(of.smallest.step);
    message.collisions.push_back(of.collisions);
  }
  message.collision_bound = prediction.collision_bound;
}

}  // namespace

std::vector<std::int64_t> spread_steps(std::int64_t steps, std::int64_t most) {
  if (steps < 1 || most < 2) throw std::invalid_argument("spread_steps: must have steps, and room for two");
  std::vector<std::int64_t> spread;
  const std::int64_t count = std::min(steps, most);
  for (std::int64_t j = 0; j < count; ++j)
    spread.push_back(count == 1 ? 0 : (j * (steps - 1) + (count - 1) / 2) / (count - 1));
  return spread;
}

Overview overview_of(const RunOptions& run, const Prediction& prediction, const RunResult& result) {
  Overview message;
  message.header.stamp = platoon_time(result.tally.platoon_time);
  message.realizations = result.realizations;
  message.time_average = run.averaging() == Averaging::over_time;
  message.complete = result.complete;
  message.attempt = result.tally.attempts;
  message.counted_from = result.counted_from;
  message.manoeuvre = result.manoeuvre;
  message.wall_seconds = result.tally.wall_seconds;
  add_verdict(prediction, message);
  const Columns columns = columns_of(run, prediction, result);
  add_cells(columns, message);
  add_provisional(result, message);
  add_gaps(prediction, result, message);
  // Evaluating all cells of a run of millions would take longer than the second until the next message.
  const bool all = result.complete || result.moments.size() <= kMostCells;
  const std::optional<Agreement> found = all ? measured_agreement(run, prediction, result)
                                             : measured_agreement(columns.run, columns.prediction, columns.result);
  message.max_abs_z_mean = found ? found->max_abs_z_mean : kNone;
  message.max_abs_z_variance = found ? found->max_abs_z_variance : kNone;
  message.plausible_z = found ? found->plausible_z : kNone;
  message.realizations_needed = found || result.realizations == 0
                                    ? kNone
                                    : (all ? realizations_needed(run, prediction, result)
                                           : realizations_needed(columns.run, columns.prediction, columns.result))
                                          .value_or(kNone);
  return message;
}

}  // namespace platoon
