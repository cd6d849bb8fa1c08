#pragma once

#include <complex>
#include <cstddef>
#include <map>
#include <unsupported/Eigen/FFT>
#include <utility>
#include <vector>

namespace platoon {

/// Sums of causal convolutions of nonnegative sequences:
/// \f[ \sum_j \sum_{l \le k} a_j(k - l) b_j(l), \qquad k = 0, \ldots, steps - 1. \f]
/// Computed by fast Fourier transforms of twice the length if their rounding leaves twelve digits, and directly
/// otherwise. O(steps log steps) per sequence, O(steps) per product.
///
/// A transform has the same absolute rounding error at every k. Sequences that grow by many decades over k are
/// therefore convolved as a(k) r^k and b(k) r^k, which gives r^k times the convolution of a and b, for as many r < 1 as
/// needed.
class CausalConvolution {
public:
  using Values = std::vector<double>;

  /// A sequence and its transforms, one per tilt r^k.
  class Prepared {
  public:
    Prepared() = default;
    explicit Prepared(Values values) : values_(std::move(values)) {}

    const Values& values() const { return values_; }
    /// Whether all values are zero.
    bool is_zero() const;

  private:
    friend class CausalConvolution;
    struct Transform {
      std::vector<std::complex<double>> spectrum;
      double size;  ///< 2-norm of the tilted sequence
    };
    Values values_;
    std::map<int, Transform> transforms_;
  };

  explicit CausalConvolution(std::size_t steps);

  struct Product {
    Prepared& a;
    Prepared& b;
  };

  /// Adds the convolutions of these products to row.
  void add(const std::vector<Product>& products, Values& row);

private:
  const Values& weights(int tilt);
  int next_tilt(const Values& row, std::size_t last_open) const;
  const Prepared::Transform& transform(Prepared& sequence, int tilt);
  void add_tilted(const std::vector<Product>& products, int tilt, Values& row, std::vector<std::size_t>& open);

  std::size_t steps_, length_ = 1;
  Eigen::FFT<double> fft_;
  std::map<int, Values> weights_;  ///< r^k per tilt
};

}  // namespace platoon
