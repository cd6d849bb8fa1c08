#pragma once

#include <complex>
#include <cstddef>
#include <unsupported/Eigen/FFT>
#include <vector>

namespace platoon {

/// Sums of causal convolutions, sum_j sum_{l <= k} a_j(k - l) b_j(l), k = 0 .. steps - 1, of sequences that are
/// nowhere negative: by fast Fourier transforms of twice the length where their rounding leaves twelve digits,
/// direct elsewhere. O(steps log steps) a sequence, O(steps) a product.
class CausalConvolution {
public:
  using Values = std::vector<double>;

  /// A sequence and what its convolutions need.
  struct Prepared {
    Values values;
    std::vector<std::complex<double>> spectrum;
    double size = 0.0;  ///< 2-norm
  };

  explicit CausalConvolution(std::size_t steps);

  Prepared prepare(Values values);

  struct Product {
    const Prepared& a;
    const Prepared& b;
  };

  /// Adds the sum of these products to row.
  void add(const std::vector<Product>& products, Values& row);

private:
  std::size_t steps_, length_ = 1;
  Eigen::FFT<double> fft_;
};

}  // namespace platoon
