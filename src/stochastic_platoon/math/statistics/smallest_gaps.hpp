#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <vector>

#include "stochastic_platoon/math/numerics/aligned_values.hpp"

namespace platoon {

struct PlatoonModel;

/// Settings for the counting of smallest gaps.
struct GapCounting {
  std::size_t followers = 0;            ///< 0: no gaps are collected
  double bin_width = 1.0;               ///< [m], of the histograms
  std::optional<double> safe_gap = {};  ///< [m], smaller gaps are counted
};

/// The counting for this model: bins of 1, 2 or 5 times a power of ten, at most a fifth of the largest standard
/// deviation of a position's noise, and 0.01 m without noise. They do not depend on the realizations.
GapCounting gap_counting(const PlatoonModel& model, std::size_t followers);

/// A gap and where it occurs. Equal gaps are ordered by realization, then by step.
struct PlacedGap {
  double gap = std::numeric_limits<double>::infinity();  ///< [m]
  std::uint64_t realization = 0;
  std::int64_t step = 0;
};

bool operator<(const PlacedGap& one, const PlacedGap& other);

/// Lowers `smallest` to the gaps wherever these are smaller. Returns the least gap.
double keep_smaller(const double* gaps, std::size_t count, double* smallest);

/// Smallest gap of every follower in every realization of one batch.
class BatchGaps {
public:
  BatchGaps(std::uint64_t first_realization, std::size_t count, std::size_t followers);

  /// Adds the gaps of a follower at a step [m], one per realization; the steps in any order.
  void add(std::size_t follower, std::int64_t step, const double* gaps);

  /// For callers that lower the smallest gaps of a follower themselves [m], its steps in ascending order: `least` is
  /// the least gap at this step.
  double* lowered(std::size_t follower) { return smallest_[follower - 1].data(); }
  void lowered_to(std::size_t follower, std::int64_t step, double least);

  std::size_t count() const { return count_; }

  /// Per realization [m]; infinite before the first step.
  const AlignedValues& smallest(std::size_t follower) const { return smallest_[follower - 1]; }

  /// The least of them, and where it first occurs.
  const PlacedGap& first(std::size_t follower) const { return first_[follower - 1]; }

private:
  std::uint64_t first_realization_;
  std::size_t count_;
  std::vector<AlignedValues> smallest_;
  std::vector<PlacedGap> first_;
};

/// Smallest gaps of one follower over a set of realizations.
struct FollowerGaps {
  PlacedGap smallest = {};
  std::uint64_t collisions = 0;  ///< realizations with a gap below 0
  std::uint64_t unsafe = 0;      ///< realizations with a gap below safe_gap
  /// Realizations by floor(smallest gap / bin width), from -kMostBins to kMostBins; these two also count all values
  /// beyond them.
  std::map<std::int64_t, std::uint64_t> histogram = {};

  static constexpr std::int64_t kMostBins = 100000;  ///< 200 m with noise of 1 cm
};

/// Smallest gaps of every follower, as a pure function of the set of realizations: counts add up, and among equal gaps
/// the first realization and step is kept.
class GapTable {
public:
  explicit GapTable(const GapCounting& counting = {}) : counting_(counting), followers_(counting.followers) {}

  bool empty() const { return followers_.empty(); }
  const GapCounting& counting() const { return counting_; }
  const std::vector<FollowerGaps>& followers() const { return followers_; }

  void add(const BatchGaps& batch);
  /// Throws std::invalid_argument for another number of followers.
  void merge(const GapTable& other);
  void merge(std::size_t follower, const FollowerGaps& more);

private:
  GapCounting counting_;
  std::vector<FollowerGaps> followers_;
};

}  // namespace platoon
