#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "stochastic_platoon/math/statistics/error_averages.hpp"

namespace platoon {

/// Mean and variance of every zeta_i(k) over the realizations of committed batches: ensemble statistics.
///
/// Several batches may be open at a time. A batch contributes only once committed, and then as a whole.
class EnsembleStatistics : public ErrorAverages {
public:
  EnsembleStatistics(std::size_t followers, std::int64_t steps, KeptMoments kept = KeptMoments::two)
      : steps_(steps), kept_(kept), table_(followers * static_cast<std::size_t>(steps)) {}

  Averaging averaging() const override { return Averaging::over_realizations; }
  void add(const ReducedErrors& errors) override;
  /// Throws std::invalid_argument if the batch is not open.
  void commit(std::uint64_t first_realization) override;
  void restart() override { open_.clear(); }
  std::uint64_t realizations() const override { return table_.count(); }
  bool empty() const override { return realizations() == 0; }
  std::int64_t last_step() const override { return steps_ - 1; }
  std::int64_t last_step(std::size_t) const override { return steps_ - 1; }
  std::vector<Moments> moments() const override { return table_.totals(); }
  const MomentTable* totals() const override { return &table_; }

  /// The batch of `size` realizations from first_realization on, opened if needed. The reference is valid until the
  /// batch is committed or discarded.
  BatchMoments& open(std::uint64_t first_realization, std::size_t size);

  /// Adds the committed realizations of an earlier run. Throws std::invalid_argument as MomentTable::merge does.
  void merge(const MomentTable& earlier) { table_.merge(earlier); }

  const MomentTable& committed() const { return table_; }

private:
  std::int64_t steps_;
  KeptMoments kept_;
  MomentTable table_;
  std::map<std::uint64_t, BatchMoments> open_;
};

}  // namespace platoon
