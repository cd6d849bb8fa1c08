#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "stochastic_platoon/math/statistics/batch_moments.hpp"
#include "stochastic_platoon/math/statistics/limit_table.hpp"
#include "stochastic_platoon/math/statistics/moment_table.hpp"
#include "stochastic_platoon/math/statistics/signal_reduction.hpp"
#include "stochastic_platoon/math/statistics/smallest_gaps.hpp"

namespace platoon {

struct FollowerSignals;
struct PlatoonModel;
struct SignalPositions;

/// Index of zeta_i(k) in tables over followers and steps: row i - 1, column k. i >= 1, 0 <= k < steps.
inline std::size_t cell(std::size_t follower, std::int64_t step, std::int64_t steps) {
  return (follower - 1) * static_cast<std::size_t>(steps) + static_cast<std::size_t>(step);
}

/// The cells of a run: the tracking errors of every follower at every step, and after them those of each requested
/// signal in the same order (see cell()).
struct SignalCells {
  std::size_t followers;
  std::int64_t steps;
  std::vector<std::string> signals = {};  ///< names: see signal_kinds()
  GapCounting gaps = {};                  ///< without followers if the gap is not among the signals
  KeptMoments kept = KeptMoments::two;
  std::vector<CountedLimits> limits = {};  ///< per follower; empty without limits

  std::size_t kinds() const { return 1 + signals.size(); }                                 ///< with the errors
  std::size_t of_one_kind() const { return followers * static_cast<std::size_t>(steps); }  ///< cells
  std::size_t count() const { return kinds() * of_one_kind(); }                            ///< cells of all kinds
  std::size_t at(std::size_t kind, std::size_t follower, std::int64_t step) const;         ///< index of a cell
  bool has_gap() const { return gaps.followers > 0; }  ///< the gap is then the first signal
};

/// The cells of this model's run.
SignalCells signal_cells(const PlatoonModel& model, std::size_t followers, std::int64_t steps,
                         const std::vector<std::string>& signals);

/// The signals of one batch of realizations.
class BatchTotals {
public:
  /// Keeps a reference to the cells.
  BatchTotals(std::uint64_t first_realization, std::size_t count, const SignalCells& cells);

  /// Adds the signals of a follower at a step, its steps in ascending order: signals_of() with the names of the cells.
  void add(std::size_t follower, std::int64_t step, const FollowerSignals& signals, const SignalPositions& positions);

  /// Adds the tracking errors that add() still holds back to reduce kCellsAtOnce at a time.
  void finish();

  BatchMoments moments;
  BatchGaps gaps;
  LimitTable limits;

private:
  const SignalCells& cells_;
  SignalReduction reduction_;
  std::array<AlignedValues, kCellsAtOnce> errors_;  ///< of `waiting_`
  std::vector<CellValues> waiting_;
};

/// All statistics over a set of realizations, as a pure function of that set.
class EnsembleTotals {
public:
  explicit EnsembleTotals(const SignalCells& cells)
      : moments(cells.count()), gaps(cells.gaps), limits(cells.limits.size()) {}
  /// Totals of moments alone, without gaps.
  explicit EnsembleTotals(MomentTable of) : moments(std::move(of)) {}
  EnsembleTotals() : moments(0) {}

  MomentTable moments;
  GapTable gaps;
  LimitTable limits;

  std::uint64_t count() const { return moments.count(); }

  /// Throws std::invalid_argument if a realization would count twice or the cells differ.
  void add(BatchTotals batch);
  void merge(const EnsembleTotals& other);
};

}  // namespace platoon
