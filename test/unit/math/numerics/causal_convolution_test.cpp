#include "stochastic_platoon/math/numerics/causal_convolution.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace platoon {
namespace {

using Values = CausalConvolution::Values;

Values direct(const Values& a, const Values& b) {
  Values sum(a.size(), 0.0);
  for (std::size_t k = 0; k < a.size(); ++k) {
    for (std::size_t l = 0; l <= k; ++l) sum[k] += a[k - l] * b[l];
  }
  return sum;
}

/// Random values in [0, 1), times 10 to the power of decades(share of the length).
template <class Decades>
Values random_values(std::size_t steps, std::mt19937_64& random, const Decades& decades) {
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  Values values;
  for (std::size_t k = 0; k < steps; ++k)
    values.push_back(uniform(random) * std::pow(10.0, decades(static_cast<double>(k) / static_cast<double>(steps))));
  return values;
}

template <class Decades>
void expect_twelve_digits(std::size_t steps, const Decades& decades) {
  std::mt19937_64 random(steps);
  CausalConvolution convolution(steps);
  std::vector<CausalConvolution::Prepared> a, b;
  Values expected(steps, 0.25);
  for (int j = 0; j < 3; ++j) {
    a.emplace_back(random_values(steps, random, decades));
    b.emplace_back(random_values(steps, random, decades));
    const Values product = direct(a.back().values(), b.back().values());
    for (std::size_t k = 0; k < steps; ++k) expected[k] += product[k];
  }
  Values row(steps, 0.25);
  convolution.add({{a[0], b[0]}, {a[1], b[1]}, {a[2], b[2]}}, row);
  for (std::size_t k = 0; k < steps; ++k) EXPECT_NEAR(row[k] / expected[k], 1.0, 2e-12) << k;
}

TEST(CausalConvolution, OfFlatSequencesHasTwelveDigits) {
  for (const std::size_t steps : {1u, 2u, 3u, 100u, 777u}) expect_twelve_digits(steps, [](double) { return 0.0; });
}

TEST(CausalConvolution, OfGrowingSequencesHasTwelveDigitsAtEveryStep) {
  expect_twelve_digits(500, [](double share) { return 60.0 * share; });
  expect_twelve_digits(500, [](double share) { return 120.0 * share; });
  expect_twelve_digits(500, [](double share) { return 90.0 * std::sqrt(share); });
  expect_twelve_digits(500, [](double share) { return share < 0.3 ? -20.0 : 200.0 * (share - 0.3); });
}

TEST(CausalConvolution, OfFallingSequencesHasTwelveDigitsAtEveryStep) {
  expect_twelve_digits(300, [](double share) { return -80.0 * share; });
}

TEST(CausalConvolution, OfZeroSequencesAddsNothing) {
  CausalConvolution convolution(3);
  CausalConvolution::Prepared zero(Values(3, 0.0)), one(Values(3, 1.0)), empty;
  EXPECT_TRUE(zero.is_zero());
  EXPECT_TRUE(empty.is_zero());
  EXPECT_FALSE(one.is_zero());
  Values row{1.0, 2.0, 3.0};
  convolution.add({}, row);
  convolution.add({{zero, one}}, row);
  EXPECT_EQ(row, (Values{1.0, 2.0, 3.0}));
}

}  // namespace
}  // namespace platoon
