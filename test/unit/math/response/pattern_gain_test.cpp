#include "stochastic_platoon/math/response/pattern_gain.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "unit/math/example_loops.hpp"

namespace platoon {
namespace {

RatedFactor factor_of(const ExampleLoop& example, double count = 1.0) {
  RatedFactor factor = rated_factor(example.loop);
  factor.factor.count = count;
  return factor;
}

double gain_at(const ExampleLoop& example, double w) {
  return std::norm(example.loop.transfer(std::polar(1.0, w)));
}

TEST(PatternGain, HasItsMaximaWhereTheGainTurns) {
  for (const ExampleLoop& example : example_loops()) {
    const std::vector<double> maxima = PatternGain({factor_of(example)}).maxima();
    constexpr int kPoints = 20000;
    for (int i = 1; i < kPoints; ++i) {
      const double step = 3.141592653589793 / kPoints, w = i * step;
      if (!(gain_at(example, w) > gain_at(example, w - step) && gain_at(example, w) > gain_at(example, w + step)))
        continue;
      const bool found =
          std::any_of(maxima.begin(), maxima.end(), [&](double m) { return std::abs(m - w) <= 1.01 * step; });
      EXPECT_TRUE(found) << example.name << " at " << w;
    }
  }
}

TEST(PatternGain, IsTheProductOverItsVehicles) {
  const ExampleLoop stable{"", 3.2, paper_loop(3.2)}, unstable{"", 2.4, paper_loop(2.4)};
  const auto of = [&](int with, int without, double w) {
    return std::pow(gain_at(stable, w), with) * std::pow(gain_at(unstable, w), without);
  };
  for (const auto& [with, without] : {std::pair<int, int>{1, 1}, {3, 1}, {20, 1}, {1, 20}, {200, 100}, {300, 10}}) {
    double largest = 0.0;
    for (int i = 1; i <= 10000; ++i) largest = std::max(largest, of(with, without, 3.141592653589793 * i / 10000));
    const LeastMargin least = PatternGain({factor_of(stable, with), factor_of(unstable, without)}).least();
    EXPECT_EQ(least.sign, largest < 1.0 ? Sign::kAbove : Sign::kBelow) << with << " and " << without;
  }
  EXPECT_NEAR(PatternGain({factor_of(stable, 1000.0)}).least().value,
              1000.0 * PatternGain({factor_of(stable)}).least().value, 1e-6);
}

TEST(PatternGain, CountsTheZerosAtZeroFrequency) {
  EXPECT_EQ(PatternGain({factor_of({"", 3.2, paper_loop(3.2)})}).zeros(), 1);
  EXPECT_EQ(PatternGain({factor_of({"", 2.8, paper_loop(2.8)})}).zeros(), 2);
  EXPECT_EQ(PatternGain({factor_of(string_stable_loops().back())}).zeros(), 2);
}

// A loop whose -ln|T|^2 has one minimum, v, with the complex zeros beside it.
TEST(PatternGain, HasMarginFrequenciesAtComplexZerosNearTheAxis) {
  const double x0 = 0.5;
  for (const double gap : {1e-4, 1e-8}) {
    Polynomial p(4);
    p << 1.0, -2.0 * x0, x0 * x0 + gap, 1.0;
    const PatternGain gain({factor_of(with_gain_from("dip", roots(p)))});
    const double w0 = std::acos(1.0 - x0), expected = std::sqrt(gap) / std::sin(w0);
    bool found = false;
    for (const std::complex<double>& w : gain.margin_frequencies())
      found = found || (std::abs(w.real() - w0) < 1e-3 && std::abs(w.imag() / expected - 1.0) < 0.02);
    EXPECT_TRUE(found) << gap;
  }
}

}  // namespace
}  // namespace platoon
