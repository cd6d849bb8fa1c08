#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "stochastic_platoon/math/statistics/time_statistics.hpp"

namespace platoon {
namespace {

constexpr std::int64_t kBurnIn = 10, kLongBurnIn = 60, kFrom = 20, kTo = 29,
                       kSteps = 150;  // of a manoeuvre, and of all

void add(TimeStatistics& statistics, std::size_t follower, std::int64_t step, bool at_limit) {
  ReducedSignals signals{follower, step, 0, 1, {std::vector<MomentNode>{{static_cast<double>(step * step % 31), 0.0}}}};
  if (at_limit) signals.at_limits[3] = 1;
  statistics.add(signals);
}

void see_leader(TimeStatistics& statistics, std::int64_t step) {
  statistics.saw_leader(step, step < kFrom || step > kTo);
}

Moments of_steps(const std::function<bool(std::int64_t)>& counts) {
  Moments all;
  for (std::int64_t k = 0; k < kSteps; ++k) {
    if (counts(k)) all.add(static_cast<double>(k * k % 31));
  }
  return all;
}

void expect_same(const Moments& one, const Moments& other) {
  EXPECT_EQ(one.count, other.count);
  EXPECT_EQ(one.mean, other.mean);
  EXPECT_EQ(one.squared_deviations, other.squared_deviations);
}

// A platoon of two, the first of which is at a limit in these steps.
TimeStatistics of_two(const std::function<bool(std::int64_t)>& at_limit, bool second_first,
                      std::int64_t burn_in = kBurnIn) {
  TimeStatistics statistics(2, burn_in, {}, {}, true);
  statistics.saw_leader(-2, true);
  for (std::int64_t k = 0; k < kSteps; ++k) {
    see_leader(statistics, k);
    if (second_first) add(statistics, 2, k, false);
    if (!second_first) add(statistics, 1, k, at_limit(k));
    if (!second_first) add(statistics, 2, k, false);
  }
  for (std::int64_t k = 0; k < kSteps && second_first; ++k) add(statistics, 1, k, at_limit(k));
  return statistics;
}

TEST(HeldBackAverages, WaitForVehiclesThatALimitHoldsBackInAnyOrderOfArrival) {
  const auto held = [](std::int64_t k) { return k >= 22 && k < 80; };
  for (const bool second_first : {false, true}) {
    const TimeStatistics statistics = of_two(held, second_first);
    const std::int64_t settled = 80 + kBurnIn;
    EXPECT_EQ(statistics.counted_from(), settled);
    const auto counts = [settled](std::int64_t from) {
      return [settled, from](std::int64_t k) { return (k >= kBurnIn && k < from) || k >= settled; };
    };
    expect_same(statistics.moments()[0], of_steps(counts(kFrom)));
    expect_same(statistics.moments()[1], of_steps(counts(kFrom + 1)));
  }
}

TEST(HeldBackAverages, GoOnWhereVehiclesAreAtALimitAnyway) {
  for (const bool always : {false, true}) {
    const TimeStatistics statistics = of_two([always](std::int64_t k) { return always || k % 7 < 3; }, false);
    expect_same(statistics.moments()[0],
                of_steps([](std::int64_t k) { return (k >= kBurnIn && k < kFrom) || k >= kTo + 1 + kBurnIn; }));
  }
  const TimeStatistics slow = of_two([](std::int64_t) { return true; }, false, kLongBurnIn);
  expect_same(slow.moments()[0], of_steps([](std::int64_t k) { return k >= kTo + 1 + kLongBurnIn; }));
}

TEST(HeldBackAverages, LeaveAManoeuvreOutFromTheStepWhereTheShortestWayBringsIt) {
  TimeStatistics statistics(4, kBurnIn, {}, {0, 1, 1, 1});
  statistics.saw_leader(-2, true);
  for (std::int64_t k = 0; k < kSteps; ++k) {
    see_leader(statistics, k - 1);
    add(statistics, 4, k, false);
  }
  // Its effect by the longest way decays last.
  expect_same(statistics.moments()[3],
              of_steps([](std::int64_t k) { return (k >= kBurnIn && k < kFrom + 1) || k >= kTo + 1 + 3 + kBurnIn; }));
}

}  // namespace
}  // namespace platoon
