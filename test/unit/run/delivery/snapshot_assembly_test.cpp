#include "stochastic_platoon/run/delivery/snapshot_assembly.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace platoon {
namespace {

constexpr double kPeriod = 0.05;  // [s]

// The message of stream i at step k.
double sent(std::size_t stream, std::int64_t step) {
  return 1000.0 * static_cast<double>(stream) + static_cast<double>(step);
}

std::optional<Snapshot> take(SnapshotAssembly& assembly, std::size_t stream, std::int64_t step, double now,
                             std::uint32_t attempt = 1, std::uint64_t first = 0) {
  return assembly.take(stream, {attempt, first, step}, sent(stream, step), now);
}

void expect_of_step(const std::optional<Snapshot>& snapshot, std::int64_t step, std::size_t streams) {
  ASSERT_TRUE(snapshot);
  EXPECT_EQ(snapshot->id.step, step);
  for (std::size_t i = 0; i < streams; ++i) {
    EXPECT_EQ(snapshot->position[i], sent(i, step));
    EXPECT_EQ(snapshot->position_before[i], sent(i, step - 1));
  }
}

TEST(SnapshotAssembly, CombinesStreamsThatAreStepsApart) {
  SnapshotAssembly assembly(3, kPeriod);
  // Stream 2 is two steps ahead of stream 0, a step every 0.1 s.
  for (std::int64_t k = -1; k < 20; ++k) {
    const double now = 0.1 * static_cast<double>(k + 1);
    if (k == -1) {
      for (const std::int64_t early : {-1, 0}) take(assembly, 2, early, now);
      take(assembly, 1, -1, now);
    }
    take(assembly, 2, k + 2, now);
    take(assembly, 1, k + 1, now);
    const std::optional<Snapshot> snapshot = take(assembly, 0, k, now);
    if (k < 2) continue;  // steps 0 and 1 arrived together
    expect_of_step(snapshot, k, 3);
  }
}

TEST(SnapshotAssembly, HasAtMostOneSnapshotPerPeriod) {
  SnapshotAssembly assembly(1, kPeriod);
  int snapshots = 0;
  constexpr int kSteps = 100000;
  for (int k = -1; k < kSteps; ++k) snapshots += take(assembly, 0, k, 1e-4 * k) ? 1 : 0;
  EXPECT_LE(snapshots, 1e-4 * kSteps / kPeriod + 2);
  EXPECT_GE(snapshots, 1e-4 * kSteps / kPeriod - 2);
}

TEST(SnapshotAssembly, HasSnapshotsAtMultiplesOfTheStride) {
  SnapshotAssembly assembly(1, kPeriod);
  assembly.set_stride(3);
  std::vector<std::int64_t> steps;
  for (int k = -1; k < 30; ++k) {
    // 50 steps a second with a jitter of some milliseconds.
    if (const auto snapshot = take(assembly, 0, k, 0.02 * k + (k % 2 == 0 ? 0.0 : 0.004)))
      steps.push_back(snapshot->id.step);
  }
  EXPECT_EQ(steps, (std::vector<std::int64_t>{0, 3, 6, 9, 12, 15, 18, 21, 24, 27}));
}

TEST(SnapshotAssembly, HasSnapshotsOfOneBatchBehindItsInitialStep) {
  SnapshotAssembly assembly(2, kPeriod);
  double now = 0.0;
  for (const std::uint64_t first : {0, 50}) {
    for (std::int64_t k = -1; k < 3; ++k) {
      now += 1.0;
      EXPECT_FALSE(take(assembly, 0, k, now, 1, first));
      const std::optional<Snapshot> snapshot = take(assembly, 1, k, now, 1, first);
      ASSERT_EQ(snapshot.has_value(), k >= 0) << k;
      if (snapshot) {
        EXPECT_EQ(snapshot->id.first_realization, first);
        expect_of_step(snapshot, k, 2);
      }
    }
  }
}

TEST(SnapshotAssembly, IgnoresAnOlderAttempt) {
  SnapshotAssembly assembly(2, kPeriod);
  for (std::int64_t k = -1; k < 5; ++k) take(assembly, 0, k, static_cast<double>(k));
  for (std::int64_t k = -1; k < 5; ++k) EXPECT_FALSE(take(assembly, 1, k, 10.0, 2));
  EXPECT_FALSE(take(assembly, 0, 5, 11.0));
  for (std::int64_t k = -1; k < 4; ++k) take(assembly, 0, k, 20.0, 2);
  take(assembly, 1, 5, 30.0, 2);
  EXPECT_FALSE(take(assembly, 0, 4, 31.0, 2));  // was not due when it was the latest
  expect_of_step(take(assembly, 0, 5, 32.0, 2), 5, 2);
}

TEST(SnapshotAssembly, ContinuesBehindAGap) {
  SnapshotAssembly assembly(2, kPeriod);
  for (std::int64_t k = -1; k < 4; ++k) take(assembly, 0, k, static_cast<double>(k));
  take(assembly, 1, -1, 5.0);
  for (const std::int64_t k : {2, 2}) EXPECT_FALSE(take(assembly, 1, k, 6.0));  // 0 and 1 are lost, 2 arrives twice
  expect_of_step(take(assembly, 1, 3, 7.0), 3, 2);
  EXPECT_THROW(take(assembly, 2, 4, 8.0), std::out_of_range);
}

}  // namespace
}  // namespace platoon
