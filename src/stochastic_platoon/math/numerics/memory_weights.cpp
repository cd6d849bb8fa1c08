#include "stochastic_platoon/math/numerics/memory_weights.hpp"

#include <algorithm>
#include <array>
#include <boost/math/constants/constants.hpp>
#include <boost/math/special_functions/legendre.hpp>
#include <cmath>
#include <cstddef>
#include <utility>

#include "stochastic_platoon/math/numerics/complex_product.hpp"

namespace platoon {

namespace {

using boost::math::double_constants::pi;

using DoubleComplex = std::complex<double>;

constexpr std::size_t kNodes = kGaussNodes;
constexpr double kFar = 2.2;   // distance from a panel's middle [half lengths] beyond which its own weights are exact
constexpr double kNear = 1.3;  // ellipse about the panel in which the recurrence of Q_l upwards keeps its digits
using Factors = std::array<DoubleComplex, kNodes>;

DoubleComplex inverse(DoubleComplex a) {
  return std::conj(a) / std::norm(a);
}

/// (2 l + 1) P_l at the Gauss nodes, by node and l.
std::array<std::array<double, kNodes>, kNodes> legendre_values() {
  std::array<std::array<double, kNodes>, kNodes> values;
  for (std::size_t k = 0; k < kNodes; ++k) {
    double before = 0.0, legendre = 1.0;
    for (unsigned l = 0; l < kNodes; ++l) {
      values[k][l] = (2.0 * l + 1.0) * legendre;
      before = std::exchange(legendre, boost::math::legendre_next(l, gauss_legendre().node[k], legendre, before));
    }
  }
  return values;
}

/// Q_0(z), ..., Q_15(z), z off [-1, 1].
Factors legendre_second(DoubleComplex z) {
  const DoubleComplex root = std::sqrt(product(z, z) - 1.0);
  const double rho = std::max(std::abs(z + root), std::abs(z - root));
  Factors q;
  q[0] = 0.5 * std::log(product(z + 1.0, inverse(z - 1.0)));
  if (rho < kNear) {
    q[1] = product(z, q[0]) - 1.0;
    for (std::size_t l = 1; l + 1 < kNodes; ++l) {
      const auto degree = static_cast<double>(l);
      q[l + 1] = ((2.0 * degree + 1.0) * product(z, q[l]) - degree * q[l - 1]) / (degree + 1.0);
    }
    return q;
  }
  // The downward recurrence of Q_l / Q_{l-1} converges by a factor rho^2 per step.
  const auto start = kNodes + static_cast<std::size_t>(20.0 / std::log(rho));
  DoubleComplex ratio = 0.0;
  std::array<DoubleComplex, kNodes> ratios;
  for (std::size_t l = start; l > 0; --l) {
    const auto degree = static_cast<double>(l);
    ratio = degree * inverse((2.0 * degree + 1.0) * z - (degree + 1.0) * ratio);
    if (l < kNodes) ratios[l] = ratio;
  }
  for (std::size_t l = 1; l < kNodes; ++l) q[l] = product(ratios[l], q[l - 1]);
  return q;
}

/// 1 / (e^u - 1) - 1 / u for abs(u) < 2 pi.
DoubleComplex beside_pole(DoubleComplex u) {
  if (std::norm(u) > 0.1) return inverse(std::exp(u) - 1.0) - inverse(u);
  const DoubleComplex square = product(u, u);
  DoubleComplex sum = 1.0 / 47900160.0;
  for (const double c : {-1.0 / 1209600.0, 1.0 / 30240.0, -1.0 / 720.0, 1.0 / 12.0}) sum = product(sum, square) + c;
  return product(sum, u) - 0.5;
}

}  // namespace

MemoryWeights::MemoryWeights(const Quadrature& rule, DoubleComplex memory)
    : rule_(rule), turn_(std::arg(memory)), decay_(-std::log(std::abs(memory))) {
  for (const long double nu : rule.node)
    remembered_.push_back(product(std::polar(1.0, static_cast<double>(nu)), memory));
}

// y / (1 - y) = 1 / (e^u - 1) with u = decay - j (nu - w + turn), whose pole 1 / u is integrated exactly.
std::vector<DoubleComplex> MemoryWeights::at(long double w) const {
  static const auto legendre = legendre_values();
  const DoubleComplex back = std::polar(1.0, static_cast<double>(-w));
  std::vector<DoubleComplex> factors;
  factors.reserve(remembered_.size());
  for (std::size_t panel = 0; panel < rule_.middle.size(); ++panel) {
    const auto half = static_cast<double>(rule_.half_length[panel]),
               from = static_cast<double>(rule_.middle[panel] - w + turn_),
               offset = from - 2.0 * pi * std::round(from / (2.0 * pi));
    if (offset * offset + decay_ * decay_ > kFar * kFar * half * half) {
      for (std::size_t k = 0; k < kNodes; ++k) {
        const DoubleComplex y = product(remembered_[panel * kNodes + k], back);
        factors.push_back(product(y, inverse(1.0 - y)));
      }
      continue;
    }
    const Factors moments = legendre_second(DoubleComplex(-offset, -decay_) / half);
    for (std::size_t k = 0; k < kNodes; ++k) {
      DoubleComplex sum = 0.0;
      for (std::size_t l = 0; l < kNodes; ++l) sum += legendre[k][l] * moments[l];
      factors.push_back(beside_pole({decay_, -offset - half * static_cast<double>(gauss_legendre().node[k])}) -
                        product(DoubleComplex(0.0, 1.0 / half), sum));
    }
  }
  return factors;
}

}  // namespace platoon
