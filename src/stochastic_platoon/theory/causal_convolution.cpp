#include "stochastic_platoon/theory/causal_convolution.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace platoon {

namespace {

constexpr double kDigits = 1e-12;          // of a row, relative
constexpr double kTransformError = 4e-16;  // of a convolution, relative to the product of the 2-norms

double norm(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum);
}

double direct(const CausalConvolution::Product& product, std::size_t k) {
  double sum = 0.0;
  for (std::size_t l = 0; l <= k; ++l) sum += product.a.values[k - l] * product.b.values[l];
  return sum;
}

}  // namespace

CausalConvolution::CausalConvolution(std::size_t steps) : steps_(steps) {
  while (length_ < 2 * steps) length_ *= 2;
  fft_.SetFlag(Eigen::FFT<double>::HalfSpectrum);
}

CausalConvolution::Prepared CausalConvolution::prepare(Values values) {
  Prepared prepared;
  Values padded = values;
  padded.resize(length_, 0.0);
  fft_.fwd(prepared.spectrum, padded);
  prepared.size = norm(values);
  prepared.values = std::move(values);
  return prepared;
}

void CausalConvolution::add(const std::vector<Product>& products, Values& row) {
  if (products.empty()) return;
  std::vector<std::complex<double>> sum(products.front().a.spectrum.size(), 0.0);
  double doubt = 0.0;
  for (const Product& product : products) {
    for (std::size_t f = 0; f < sum.size(); ++f) sum[f] += product.a.spectrum[f] * product.b.spectrum[f];
    doubt += kTransformError * product.a.size * product.b.size;
  }
  Values added;
  fft_.inv(added, sum, static_cast<Eigen::Index>(length_));
  for (std::size_t k = 0; k < steps_; ++k) {
    if (doubt <= kDigits * (row[k] + added[k])) {
      row[k] += std::max(added[k], 0.0);
      continue;
    }
    for (const Product& product : products) row[k] += direct(product, k);
  }
}

}  // namespace platoon
