#include "stochastic_platoon/math/statistics/moment_table.hpp"

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>

namespace platoon {

namespace {

// Turns the left child into the parent of both.
void join(MomentBlock& left, const MomentBlock& right) {
  const double half_count = 0.5 * static_cast<double>(left.range.size());
  for (std::size_t c = 0; c < left.fourth_deviations.size(); ++c) {
    merge_equal_powers(right.mean[c] - left.mean[c], left.deviations(c), right.deviations(c), half_count,
                       &left.cubed_deviations[c], &left.fourth_deviations[c]);
  }
  for (std::size_t c = 0; c < left.mean.size(); ++c) {
    merge_equal(left.mean[c], left.squared_deviations[c], right.mean[c], right.squared_deviations[c], half_count,
                &left.mean[c], &left.squared_deviations[c]);
  }
  ++left.range.level;
}

}  // namespace

std::uint64_t MomentTable::count() const {
  std::uint64_t sum = 0;
  for (const auto& entry : blocks_) sum += entry.second.range.size();
  return sum;
}

void MomentTable::add(MomentBlock block) {
  if (block.mean.size() != cells_ || block.squared_deviations.size() != cells_) {
    throw std::invalid_argument("block of " + std::to_string(block.mean.size()) + " cells: must have " +
                                std::to_string(cells_));
  }
  // Larger ranges, which a file may contain, would overflow the end of a range.
  if (block.range.level > 62 || block.range.first % block.range.size() != 0 ||
      block.range.first > (std::uint64_t{1} << 62)) {
    throw std::invalid_argument("realizations from " + std::to_string(block.range.first) + " at level " +
                                std::to_string(block.range.level) + ": must be a node of the binary tree");
  }
  const std::size_t powers =
      blocks_.empty() ? block.fourth_deviations.size() : blocks_.begin()->second.fourth_deviations.size();
  if (block.cubed_deviations.size() != powers || block.fourth_deviations.size() != powers ||
      (powers != 0 && powers != cells_)) {
    throw std::invalid_argument("block of " + std::to_string(block.fourth_deviations.size()) +
                                " fourth moments: must have " + std::to_string(powers));
  }
  const auto after = blocks_.lower_bound(block.range.first);
  const bool overlaps_next = after != blocks_.end() && after->first < block.range.end();
  const bool overlaps_previous = after != blocks_.begin() && std::prev(after)->second.range.end() > block.range.first;
  if (overlaps_next || overlaps_previous) {
    throw std::invalid_argument("realizations from " + std::to_string(block.range.first) + " to " +
                                std::to_string(block.range.end() - 1) + ": must not be counted twice");
  }
  while (true) {
    const DyadicRange range = block.range;
    const std::uint64_t sibling_first = range.is_left_child() ? range.end() : range.first - range.size();
    const auto sibling = blocks_.find(sibling_first);
    if (sibling == blocks_.end() || sibling->second.range.level != range.level) break;
    if (!range.is_left_child()) std::swap(block, sibling->second);
    join(block, sibling->second);
    blocks_.erase(sibling);
  }
  const std::uint64_t first = block.range.first;
  blocks_.emplace(first, std::move(block));
}

void MomentTable::add(BatchMoments batch) {
  for (MomentBlock& block : batch.release()) add(std::move(block));
}

void MomentTable::merge(const MomentTable& other) {
  for (const auto& entry : other.blocks_) add(entry.second);
}

std::vector<RealizationRange> MomentTable::missing(const RealizationRange& range) const {
  std::vector<RealizationRange> gaps;
  std::uint64_t next = range.first;
  for (const auto& entry : blocks_) {
    const DyadicRange& there = entry.second.range;
    if (there.first >= range.end) break;
    if (there.first > next) gaps.push_back({next, there.first});
    next = std::max(next, there.end());
  }
  if (next < range.end) gaps.push_back({next, range.end});
  return gaps;
}

std::vector<Moments> MomentTable::totals() const {
  std::vector<Moments> totals(cells_);
  for (const auto& entry : blocks_) {
    const MomentBlock& block = entry.second;
    for (std::size_t c = 0; c < cells_; ++c) {
      Moments more{block.range.size(), block.mean[c], block.squared_deviations[c]};
      if (!block.fourth_deviations.empty()) {
        more.cubed_deviations = block.cubed_deviations[c];
        more.fourth_deviations = block.fourth_deviations[c];
      }
      totals[c] = platoon::merge(totals[c], more);
    }
  }
  return totals;
}

}  // namespace platoon
