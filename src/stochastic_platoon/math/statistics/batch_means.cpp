#include "stochastic_platoon/math/statistics/batch_means.hpp"

#include <algorithm>
#include <cstddef>

#include "stochastic_platoon/math/numerics/special_values.hpp"

namespace platoon {

namespace {

constexpr double kMostCorrelation = 0.6;

/// max(c_0, c_0 + 2 c_1) of a sequence; NaN if neighbours are correlated too strongly.
double variance_of_batches(const std::vector<double>& batches) {
  const auto count = static_cast<double>(batches.size());
  double mean = 0.0, square = 0.0, product = 0.0;
  for (const double value : batches) mean += value / count;
  for (std::size_t j = 0; j < batches.size(); ++j) {
    const double deviation = batches[j] - mean;
    square += deviation * deviation;
    if (j > 0) product += deviation * (batches[j - 1] - mean);
  }
  if (product > kMostCorrelation * square) return kNaN;
  return (square + std::max(0.0, 2.0 * product)) / (count - 1.0);
}

}  // namespace

void BatchMeans::add(double value) {
  filling_.add(value);
  if (filling_.count < length_) return;
  full_.push_back(filling_);
  filling_ = {};
  if (full_.size() < kMostBatches) return;
  for (std::size_t j = 0; j < kMostBatches / 2; ++j) full_[j] = merge(full_[2 * j], full_[2 * j + 1]);
  full_.resize(kMostBatches / 2);
  length_ *= 2;
}

IndependentShare BatchMeans::share() const {
  if (full_.size() < kMostBatches / 2) return {kNaN, kNaN, kNaN};
  Moments all;
  for (const Moments& batch : full_) all = merge(all, batch);
  std::vector<double> means, squares;
  const auto length = static_cast<double>(length_);
  for (const Moments& batch : full_) {
    const double shift = batch.mean - all.mean;
    means.push_back(batch.mean);
    squares.push_back(batch.squared_deviations / length + shift * shift);
  }
  const double variance = all.variance();
  if (!(variance > 0.0)) return {kNaN, kNaN, kNaN};
  return {variance / (length * variance_of_batches(means)),
          2.0 * variance * variance / (length * variance_of_batches(squares)), kNaN};
}

}  // namespace platoon
