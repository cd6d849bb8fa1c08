#include "stochastic_platoon/math/numerics/memory_weights.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace platoon {
namespace {

using Complex = std::complex<double>;

// f = 1 / |e^{j nu} - a|^2 has the lags a^t / (1 - a^2), of which y / (1 - y) takes those above 0 times lambda^t.
Complex remembered(double memory, double a, double w) {
  const Complex x = memory * a * std::polar(1.0, -w);
  return x / (1.0 - x) / (1.0 - a * a);
}

TEST(MemoryWeights, IntegrateAKernelThatTheNodesDoNotResolve) {
  for (const double memory : {0.3, -0.3, 0.9, -0.97, 0.999, -0.999, 0.99999}) {
    for (const double a : {0.5, 0.97}) {
      const Quadrature rule = half_circle_quadrature({{0.0, -std::log(a)}}, {}, 1);
      const MemoryWeights weights(rule, memory);
      for (const double w : {0.0, 0.01, 0.3, 1.0, 2.5, 3.1, 3.141592653589793}) {
        const std::vector<Complex> ahead = weights.at(w), behind = weights.at(-w);
        Complex sum = 0.0;
        for (std::size_t k = 0; k < rule.node.size(); ++k) {
          const double f = 1.0 / std::norm(std::polar(1.0, static_cast<double>(rule.node[k])) - a);
          sum += 0.5 * rule.weight[k] * f * (ahead[k] + std::conj(behind[k]));
        }
        const Complex exact = remembered(memory, a, w);
        const double tolerance = 1e-12 + 1e-16 / (1.0 - std::abs(memory));  // of lambda itself
        EXPECT_LT(std::abs(sum - exact), tolerance * std::abs(exact)) << memory << " " << a << " " << w;
      }
    }
  }
}

}  // namespace
}  // namespace platoon
