#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <vector>

#include "stochastic_platoon/statistics/moment_table.hpp"

namespace platoon {

/// Place of zeta_i(k) in every table of this project: row i - 1, column k. i >= 1, 0 <= k < steps.
inline std::size_t cell(std::size_t follower, std::int64_t step, std::int64_t steps) {
  return (follower - 1) * static_cast<std::size_t>(steps) + static_cast<std::size_t>(step);
}

/// Mean and variance of every zeta_i(k) over the realizations of committed batches: ensemble statistics.
///
/// Batches may be open side by side. An open batch counts for nothing until it is committed, then for all of
/// it.
class EnsembleStatistics {
public:
  EnsembleStatistics(std::size_t followers, std::int64_t steps)
      : steps_(steps), table_(followers * static_cast<std::size_t>(steps)) {}

  /// The batch of `size` realizations from first_realization on, begun if it is not open yet. Stays where it
  /// is until it is committed or discarded.
  BatchMoments& open(std::uint64_t first_realization, std::size_t size);

  /// zeta_i(k) of the batch that begins at first_realization, one value per realization [m]. Several threads
  /// may do so at once, each for cells of its own, also while another batch is committed.
  void add(std::size_t follower, std::int64_t step, std::uint64_t first_realization,
           const std::vector<double>& errors) {
    open(first_realization, errors.size()).set(cell(follower, step, steps_), errors.data());
  }

  /// Counts the batch in. Throws std::invalid_argument when it is not open.
  void commit(std::uint64_t first_realization);

  /// Forgets the open batches. Nobody may be adding to one.
  void discard_open();

  /// Takes over what an earlier run had committed. Throws std::invalid_argument as MomentTable::merge does.
  void merge(const MomentTable& earlier) { table_.merge(earlier); }

  const MomentTable& committed() const { return table_; }
  std::int64_t steps() const { return steps_; }

private:
  std::int64_t steps_;
  MomentTable table_;
  std::mutex opening_;  ///< of open_
  std::map<std::uint64_t, BatchMoments> open_;
};

}  // namespace platoon
