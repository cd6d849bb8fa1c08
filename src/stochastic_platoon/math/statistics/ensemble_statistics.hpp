#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "stochastic_platoon/math/statistics/error_averages.hpp"

namespace platoon {

/// Mean and variance of every zeta_i(k), and of every other signal, over the realizations of committed batches:
/// ensemble statistics.
///
/// Several batches may be open at a time. A batch contributes only once committed, and then as a whole.
class EnsembleStatistics : public ErrorAverages {
public:
  explicit EnsembleStatistics(const SignalCells& cells) : cells_(cells), totals_(cells) {}

  void add(const ReducedSignals& signals) override;
  /// Throws std::invalid_argument if the batch is not open.
  void commit(std::uint64_t first_realization) override;
  void restart() override { open_.clear(); }
  std::uint64_t realizations() const override { return totals_.count(); }
  bool empty() const override { return realizations() == 0; }
  std::int64_t last_step(std::size_t) const override { return cells_.steps - 1; }
  std::vector<Moments> moments() const override { return totals_.moments.totals(); }
  const EnsembleTotals* totals() const override { return &totals_; }

  /// Adds the committed realizations of an earlier run. Throws std::invalid_argument as EnsembleTotals::merge does.
  void merge(const EnsembleTotals& earlier) { totals_.merge(earlier); }

private:
  SignalCells cells_;
  EnsembleTotals totals_;
  std::map<std::uint64_t, BatchTotals> open_;
};

}  // namespace platoon
