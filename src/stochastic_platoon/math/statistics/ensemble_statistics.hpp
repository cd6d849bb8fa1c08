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
  explicit EnsembleStatistics(const SignalCells& cells, KeptMoments kept = KeptMoments::two)
      : cells_(cells), kept_(kept), totals_(cells) {}

  Averaging averaging() const override { return Averaging::over_realizations; }
  void add(const ReducedSignals& signals) override;
  /// Throws std::invalid_argument if the batch is not open.
  void commit(std::uint64_t first_realization) override;
  void restart() override { open_.clear(); }
  std::uint64_t realizations() const override { return totals_.count(); }
  bool empty() const override { return realizations() == 0; }
  std::int64_t last_step() const override { return cells_.steps - 1; }
  std::int64_t last_step(std::size_t) const override { return cells_.steps - 1; }
  std::vector<Moments> moments() const override { return totals_.moments.totals(); }
  const EnsembleTotals* totals() const override { return &totals_; }

  /// The batch of `size` realizations from first_realization on, opened if needed. The reference is valid until the
  /// batch is committed or discarded.
  BatchTotals& open(std::uint64_t first_realization, std::size_t size);

  /// Adds the committed realizations of an earlier run. Throws std::invalid_argument as EnsembleTotals::merge does.
  void merge(const EnsembleTotals& earlier) { totals_.merge(earlier); }

  const EnsembleTotals& committed() const { return totals_; }

private:
  SignalCells cells_;
  KeptMoments kept_;
  EnsembleTotals totals_;
  std::map<std::uint64_t, BatchTotals> open_;
};

}  // namespace platoon
