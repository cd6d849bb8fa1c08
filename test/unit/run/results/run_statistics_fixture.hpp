#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "stochastic_platoon/math/channel/awgn_channel.hpp"
#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/model/vehicle.hpp"
#include "stochastic_platoon/run/results/run_statistics.hpp"
#include "unit/monte_carlo.hpp"
#include "unit/paper_run.hpp"
#include "unit/same_bits.hpp"
#include "unit/transmitted.hpp"

namespace platoon {

/// A run of the paper's example whose positions the test passes to RunStatistics.
class RunStatisticsTest : public testing::Test {
protected:
  /// The positions of each vehicle at each step, from step -1 on.
  class BatchPositions {
  public:
    void add(std::size_t vehicle, const std::vector<double>& values) {
      if (vehicle == all_.size()) all_.emplace_back();
      all_[vehicle].push_back(std::make_shared<const std::vector<double>>(values));
    }
    const Positions& at(std::size_t vehicle, std::int64_t step) const {
      return all_[vehicle][static_cast<std::size_t>(step - kInitialStep)];
    }
    std::size_t vehicles() const { return all_.size(); }

  private:
    std::vector<std::vector<Positions>> all_;
  };

  /// Steps -1 to steps - 1 of a batch, as the nodes publish them.
  BatchPositions positions_of(std::uint64_t first, std::int64_t steps) const {
    const std::size_t count = configuration_.run.schedule().size(first);
    BatchPositions all;
    LeaderVehicle leader(configuration_.model);
    all.add(0, std::vector<double>(count, leader.start()));
    for (std::int64_t k = 0; k < steps; ++k) all.add(0, std::vector<double>(count, leader.step()));
    for (std::uint32_t i = 1; i <= configuration_.run.followers; ++i) {
      FollowerVehicle follower(configuration_.model, configuration_.run.seed, i);
      const AwgnChannel channel(configuration_.model.default_vehicle().position().noise_variance,
                                configuration_.run.seed, i);
      std::vector<double> own;
      follower.start(first, count, own);
      all.add(i, own);
      for (std::int64_t k = 0; k < steps; ++k) {
        follower.step(transmitted(channel, k - 1, first, *all.at(i - 1, k - 1)), own);
        all.add(i, own);
      }
    }
    return all;
  }

  static DropReason take(RunStatistics& statistics, std::size_t vehicle, const MessageId& id,
                         const Positions& positions) {
    return statistics.take(vehicle, {id, positions->size(), true}, positions);
  }

  /// Passes the batch on step by step, up to `last_step`.
  void receive_batch(RunStatistics& statistics, std::uint32_t attempt, std::uint64_t first,
                     std::int64_t last_step = 2) const {
    const BatchPositions all = positions_of(first, last_step + 1);
    for (std::int64_t k = kInitialStep; k <= last_step; ++k) {
      for (std::size_t i = 0; i < all.vehicles(); ++i)
        ASSERT_EQ(take(statistics, i, {attempt, first, k}, all.at(i, k)), DropReason::none);
    }
  }

  EnsembleTotals monte_carlo_of(std::uint64_t realizations) const {
    const RunOptions& run = configuration_.run;
    return monte_carlo(configuration_.model, {run.seed, run.followers, run.steps, 8192, run.signals}, realizations);
  }
  void expect_monte_carlo(const RunStatistics& statistics, std::uint64_t realizations) const {
    expect_same_bits(statistics.averages().moments(), monte_carlo_of(realizations).moments.totals());
  }

  Configuration configuration_ = paper_run("");
};

}  // namespace platoon
