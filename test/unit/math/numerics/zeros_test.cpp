#include "stochastic_platoon/math/numerics/zeros.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace platoon {
namespace {

ExactPolynomial with_zeros(const std::vector<double>& zeros) {
  ExactPolynomial p{Exact(1)};
  for (const double zero : zeros) p = multiply(p, {-Exact(zero), Exact(1)});
  return p;
}

std::vector<long double> real_parts(const std::vector<std::complex<long double>>& zeros) {
  std::vector<long double> found;
  for (const std::complex<long double>& s : zeros) found.push_back(s.real());
  std::sort(found.begin(), found.end());
  return found;
}

void expect_zeros(std::vector<double> expected, long double accuracy) {
  const std::vector<long double> found = real_parts(zeros(with_zeros(expected)));
  std::sort(expected.begin(), expected.end());
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_LE(std::abs(found[i] - static_cast<long double>(expected[i])),
              accuracy * std::abs(static_cast<long double>(expected[i])))
        << expected[i];
  }
}

// a(s) (1 + s)^delay + b(s) is 0 at its zeros, to the rounding of its terms.
TEST(Zeros, BehindALongDelayAreZeros) {
  const ExactPolynomial a{Exact("0.01"), Exact("0.25"), Exact(1)}, b{Exact("0.011"), Exact("0.3")};
  for (const std::size_t delay : {0u, 7u, 190u, 300u, 700u}) {
    const std::vector<std::complex<long double>> found = zeros_behind_delay(a, delay, b);
    ASSERT_EQ(found.size(), delay + 2);
    std::complex<long double> sum = 0.0L;
    for (const std::complex<long double>& s : found) {
      const std::complex<long double> first = (s * s + 0.25L * s + 0.01L) * std::pow(1.0L + s, static_cast<int>(delay)),
                                      second = 0.3L * s + 0.011L;
      const long double length = std::abs(s), sizes = (length * length + 0.25L * length + 0.01L) *
                                                          std::pow(std::abs(1.0L + s), static_cast<int>(delay)) +
                                                      0.3L * length + 0.011L;
      EXPECT_LT(std::abs(first + second), 1e-15L * sizes) << delay;
      sum += 1.0L + s;
    }
    // z^2 - 1.75 z + 0.76 times z^delay, and 0.3 z - 0.289: no zero is found twice in place of another.
    EXPECT_NEAR(static_cast<double>(std::abs(sum - (delay == 0 ? 1.45L : 1.75L))), 0.0, 1e-9) << delay;
  }
}

TEST(Zeros, AreAccurateEachWhateverTheirScales) {
  expect_zeros({-3e13, -0.5, -0.9}, 1e-15L);
  expect_zeros({-1e-3, 1e-9, -2.0, 3e13, -0.25, -1e-3 - 1e-9}, 1e-15L);
  expect_zeros({-1e-150, 1e-100, -1e-50, -1.0 / 3.0, 1e50, -1e100, 1e150}, 1e-15L);
}

TEST(Zeros, OfAHighDegreeAreThoseOfTheExactCoefficients) {
  std::vector<double> places;
  for (int i = 0; i < 20; ++i) places.push_back(-0.1 - 0.02 * i);
  expect_zeros(places, 1e-15L);
}

TEST(Zeros, ThatAreMultipleHaveTheSumAndTheProductOfTheCoefficients) {
  for (const std::size_t count : {2u, 3u, 5u}) {
    const std::vector<std::complex<long double>> found = zeros(with_zeros(std::vector<double>(count, -0.1)));
    ASSERT_EQ(found.size(), count);
    std::complex<long double> product = 1.0L, sum = 0.0L;
    for (const std::complex<long double>& s : found) {
      product *= s / -0.1L;
      sum += s / -0.1L;
    }
    EXPECT_LT(std::abs(product - 1.0L), 1e-15L) << count;
    EXPECT_LT(std::abs(sum - static_cast<long double>(count)), 1e-15L) << count;
  }
}

TEST(Zeros, AreOrderedInConjugatePairsAndRealOnesAreReal) {
  // (s + 0.5) (s - 4) ((s + a)^2 + b^2) for two pairs
  ExactPolynomial p = with_zeros({-0.5, 4.0});
  for (const double a : {0.25, -1e-6}) p = multiply(p, {Exact(a) * a + Exact(0.0625), 2 * Exact(a), Exact(1)});
  const std::vector<std::complex<long double>> found = zeros(p);
  ASSERT_EQ(found.size(), 6u);
  int real = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i].imag() == 0.0L) {
      ++real;
      continue;
    }
    ASSERT_LT(i + 1, found.size());
    EXPECT_LT(std::abs(found[i + 1] - std::conj(found[i])), 1e-17L) << i;
    ++i;
  }
  EXPECT_EQ(real, 2);
}

}  // namespace
}  // namespace platoon
