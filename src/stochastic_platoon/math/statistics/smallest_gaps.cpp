#include "stochastic_platoon/math/statistics/smallest_gaps.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <tuple>

#include "stochastic_platoon/math/model/input.hpp"
#include "stochastic_platoon/math/model/platoon_model.hpp"
#include "stochastic_platoon/math/numerics/special_values.hpp"
#include "stochastic_platoon/math/numerics/vector_clones.hpp"
#include "stochastic_platoon/math/statistics/lane_tree.hpp"

namespace platoon {

namespace detail {

// The least gap of each lane. The first lane includes the gaps that fill no vector.
PLATOON_VECTOR_CLONES
std::array<double, kCellsAtOnce> lower(const double* gaps, std::size_t count, double* smallest) {
  Lanes least = Lanes{} + kInfinity;
  std::size_t r = 0;
  for (; r + kCellsAtOnce <= count; r += kCellsAtOnce) {
    Lanes gap;
    load(gaps + r, gap);
    lower_lanes(gap, smallest + r, least);
  }
  std::array<double, kCellsAtOnce> found{least[0], least[1], least[2], least[3]};
  for (; r < count; ++r) {
    smallest[r] = std::min(smallest[r], gaps[r]);
    found[0] = std::min(found[0], gaps[r]);
  }
  return found;
}

// Index of the first value that equals `sought`, or `count`; compared block by block, as a search value by value takes
// several times as long.
PLATOON_VECTOR_CLONES
std::size_t first_of(const double* values, std::size_t count, double sought) {
  constexpr std::size_t kBlock = 64;
  std::size_t r = 0;
  for (; r + kBlock <= count; r += kBlock) {
    std::int64_t found = 0;
    for (std::size_t j = 0; j < kBlock; ++j) found |= values[r + j] == sought ? 1 : 0;
    if (found != 0) break;
  }
  while (r < count && values[r] != sought) ++r;
  return r;
}

// floor(gap / bin_width) from -most to most.
PLATOON_VECTOR_CLONES
void find_bins(const double* gaps, std::size_t count, double bin_width, double most, std::int32_t* bins) {
  for (std::size_t r = 0; r < count; ++r) {
    const double bin = std::floor(gaps[r] / bin_width);
    bins[r] = static_cast<std::int32_t>(bin < -most ? -most : bin > most ? most : bin);
  }
}

// Number of gaps below the limit.
PLATOON_VECTOR_CLONES
std::uint64_t count_below(const double* gaps, std::size_t count, double limit) {
  std::uint64_t found = 0;
  for (std::size_t r = 0; r < count; ++r) found += gaps[r] < limit ? 1 : 0;
  return found;
}

}  // namespace detail

double keep_smaller(const double* gaps, std::size_t count, double* smallest) {
  const std::array<double, kCellsAtOnce> least = detail::lower(gaps, count, smallest);
  return *std::min_element(least.begin(), least.end());
}

bool operator<(const PlacedGap& one, const PlacedGap& other) {
  return std::tie(one.gap, one.realization, one.step) < std::tie(other.gap, other.realization, other.step);
}

GapCounting gap_counting(const PlatoonModel& model, std::size_t followers) {
  double variance = 0.0;
  for (const VehicleModel& of : pattern(model)) {
    for (const Input& input : of.inputs) {
      if (input.signal == InputSignal::position) variance = std::max(variance, input.noise_variance);
    }
  }
  const double most = variance > 0.0 ? std::sqrt(variance) / 5.0 : 0.01;
  // As a quotient of whole numbers, so that the bins' ends have few digits.
  double width = 1.0, divisor = 1.0;
  while (width / divisor > most) divisor *= 10.0;
  for (double next = 10.0 * width; next / divisor <= most; next *= 10.0) width = next;
  for (const double factor : {5.0, 2.0}) {
    if (factor * width / divisor <= most) return {followers, factor * width / divisor, model.safe_gap};
  }
  return {followers, width / divisor, model.safe_gap};
}

BatchGaps::BatchGaps(std::uint64_t first_realization, std::size_t count, std::size_t followers)
    : first_realization_(first_realization),
      count_(count),
      smallest_(followers, AlignedValues(count, kInfinity)),
      first_(followers) {}

void BatchGaps::add(std::size_t follower, std::int64_t step, const double* gaps) {
  AlignedValues& smallest = smallest_.at(follower - 1);
  PlacedGap& first = first_[follower - 1];
  if (!(keep_smaller(gaps, count_, smallest.data()) <= first.gap)) return;
  for (std::size_t r = 0; r < count_; ++r) {
    if (gaps[r] <= first.gap) first = std::min(first, PlacedGap{gaps[r], first_realization_ + r, step});
  }
}

void BatchGaps::lowered_to(std::size_t follower, std::int64_t step, double least) {
  PlacedGap& first = first_.at(follower - 1);
  if (!(least <= first.gap)) return;
  // If this realization had the gap at an earlier step already, that step is kept.
  const AlignedValues& smallest = smallest_[follower - 1];
  const std::size_t r = detail::first_of(smallest.data(), count_, least);
  first = std::min(first, PlacedGap{least, first_realization_ + r, step});
}

void GapTable::add(const BatchGaps& batch) {
  constexpr auto kMost = static_cast<double>(FollowerGaps::kMostBins);
  std::vector<std::int32_t> bins(batch.count());
  for (std::size_t i = 1; i <= followers_.size(); ++i) {
    FollowerGaps& of = followers_[i - 1];
    const AlignedValues& gaps = batch.smallest(i);
    of.smallest = std::min(of.smallest, batch.first(i));
    of.collisions += detail::count_below(gaps.data(), gaps.size(), 0.0);
    if (counting_.safe_gap) of.unsafe += detail::count_below(gaps.data(), gaps.size(), *counting_.safe_gap);
    detail::find_bins(gaps.data(), gaps.size(), counting_.bin_width, kMost, bins.data());
    // Counted in an array first, and then added from the least bin on: searching the map for every gap takes an order
    // of magnitude longer.
    const auto [least, most] = std::minmax_element(bins.begin(), bins.end());
    std::vector<std::uint64_t> counts(static_cast<std::size_t>(*most - *least) + 1);
    for (const std::int32_t bin : bins) ++counts[static_cast<std::size_t>(bin - *least)];
    auto next = of.histogram.lower_bound(*least);
    for (std::size_t j = 0; j < counts.size(); ++j) {
      const std::int64_t bin = std::int64_t{*least} + static_cast<std::int64_t>(j);
      if (counts[j] == 0) continue;
      while (next != of.histogram.end() && next->first < bin) ++next;
      next = of.histogram.try_emplace(next, bin, 0);
      next->second += counts[j];
    }
  }
}

void GapTable::merge(std::size_t follower, const FollowerGaps& more) {
  FollowerGaps& of = followers_.at(follower - 1);
  of.smallest = std::min(of.smallest, more.smallest);
  of.collisions += more.collisions;
  of.unsafe += more.unsafe;
  for (const auto& [bin, count] : more.histogram) of.histogram[bin] += count;
}

void GapTable::merge(const GapTable& other) {
  if (other.followers_.size() != followers_.size()) {
    throw std::invalid_argument("smallest gaps of " + std::to_string(other.followers_.size()) +
                                " followers: must be of " + std::to_string(followers_.size()));
  }
  for (std::size_t i = 1; i <= followers_.size(); ++i) merge(i, other.followers_[i - 1]);
}

}  // namespace platoon
