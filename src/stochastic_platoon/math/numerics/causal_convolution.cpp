#include "stochastic_platoon/math/numerics/causal_convolution.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "stochastic_platoon/math/numerics/interruption.hpp"

namespace platoon {

namespace {

constexpr double kDigits = 1e-12;          // relative accuracy of a row
constexpr double kTransformError = 4e-16;  // rounding of a convolution, relative to the product of the 2-norms
constexpr double kDecades = 5.0;           // decrease of r^k over all steps per unit of tilt
constexpr int kMostTilts = 50;             // keeps r^k a normal number
constexpr double kTransformCost = 16.0;    // of one product in a tilted sum, in multiplications of direct()

double norm(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum);
}

double direct(const CausalConvolution::Product& product, std::size_t k) {
  double sum = 0.0;
  for (std::size_t l = 0; l <= k; ++l) sum += product.a.values()[k - l] * product.b.values()[l];
  return sum;
}

}  // namespace

bool CausalConvolution::Prepared::is_zero() const {
  return std::all_of(values_.begin(), values_.end(), [](double value) { return value == 0.0; });
}

CausalConvolution::CausalConvolution(std::size_t steps) : steps_(steps) {
  while (length_ < 2 * steps) length_ *= 2;
  fft_.SetFlag(Eigen::FFT<double>::HalfSpectrum);
}

const CausalConvolution::Values& CausalConvolution::weights(int tilt) {
  Values& weights = weights_[tilt];
  for (std::size_t k = weights.size(); k < steps_; ++k)
    weights.push_back(std::pow(10.0, -kDecades * tilt * static_cast<double>(k) / static_cast<double>(steps_)));
  return weights;
}

const CausalConvolution::Prepared::Transform& CausalConvolution::transform(Prepared& sequence, int tilt) {
  const auto [found, is_new] = sequence.transforms_.try_emplace(tilt);
  if (!is_new) return found->second;
  Values padded(length_, 0.0);
  const Values& weights = this->weights(tilt);
  for (std::size_t k = 0; k < sequence.values_.size(); ++k) padded[k] = sequence.values_[k] * weights[k];
  fft_.fwd(found->second.spectrum, padded);
  found->second.size = norm(padded);
  return found->second;
}

// Removes from `open` the steps that this tilt resolves to kDigits.
void CausalConvolution::add_tilted(const std::vector<Product>& products, int tilt, Values& row,
                                   std::vector<std::size_t>& open) {
  std::vector<std::complex<double>> sum(length_ / 2 + 1, 0.0);
  double doubt = 0.0;
  for (const Product& product : products) {
    check_interruption();
    const Prepared::Transform &a = transform(product.a, tilt), &b = transform(product.b, tilt);
    for (std::size_t f = 0; f < sum.size(); ++f) sum[f] += a.spectrum[f] * b.spectrum[f];
    doubt += kTransformError * a.size * b.size;
  }
  Values added;
  fft_.inv(added, sum, static_cast<Eigen::Index>(length_));
  const Values& weights = this->weights(tilt);
  const auto close = [&](std::size_t k) {
    if (!(doubt <= kDigits * (row[k] * weights[k] + added[k]))) return false;
    row[k] += std::max(added[k], 0.0) / weights[k];
    return true;
  };
  open.erase(std::remove_if(open.begin(), open.end(), close), open.end());
}

// The tilt that matches the growth of the row just after the last open step; 0 if it cannot be determined.
int CausalConvolution::next_tilt(const Values& row, std::size_t last_open) const {
  const std::size_t from = last_open + 1, to = std::min(from + steps_ / 32 + 1, steps_ - 1);
  if (from >= to || !(row[from] > 0.0) || !std::isfinite(row[to])) return 0;
  const double decades = std::log10(row[to] / row[from]) / static_cast<double>(to - from);
  return static_cast<int>(std::lround(decades * static_cast<double>(steps_) / kDecades));
}

void CausalConvolution::add(const std::vector<Product>& products, Values& row) {
  if (products.empty()) return;
  std::vector<std::size_t> open(steps_);
  std::iota(open.begin(), open.end(), 0);
  for (int tilt = 0; tilt <= kMostTilts; tilt = std::max(tilt + 1, next_tilt(row, open.back()))) {
    add_tilted(products, tilt, row, open);
    double of_direct = 0.0;
    for (const std::size_t k : open) of_direct += static_cast<double>(k + 1);
    if (of_direct < kTransformCost * static_cast<double>(length_)) break;
  }
  for (const std::size_t k : open) {
    check_interruption();
    for (const Product& product : products) row[k] += direct(product, k);
  }
}

}  // namespace platoon
