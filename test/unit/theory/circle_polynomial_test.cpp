#include "stochastic_platoon/theory/circle_polynomial.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

namespace platoon {
namespace {

Polynomial sample_polynomial() {
  Polynomial p(6);
  p << 2.0, -1.5, 0.25, 3.0, -0.5, 0.75;
  return p;
}

/// The product of (t - zero).
CirclePolynomial with_zeros(const std::vector<long double>& zeros) {
  CirclePolynomial p{1.0L};
  for (const long double zero : zeros) p = multiply(p, {-zero, 1.0L});
  return p;
}

TEST(CirclePolynomial, TaylorCoefficientsRebuildThePolynomial) {
  const Polynomial p = sample_polynomial();
  for (const Centre centre : {Centre::kOne, Centre::kMinusOne}) {
    const CirclePolynomial b = taylor(p, centre);
    const double c = centre == Centre::kOne ? 1.0 : -1.0;
    for (const double z : {-2.0, -0.3, 0.0, 1.7}) {
      EXPECT_NEAR(static_cast<double>(evaluate(b, z - c)), evaluate(p, z).real(), 1e-13);
    }
  }
}

TEST(CirclePolynomial, SquaredModulusIsThatOfThePolynomialOnTheUnitCircle) {
  const Polynomial p = sample_polynomial();
  for (const Centre centre : {Centre::kOne, Centre::kMinusOne}) {
    const CirclePolynomial b = taylor(p, centre);
    const CirclePolynomial square = squared_modulus(b, centre);
    for (double w = 0.0; w <= 3.1416; w += 0.1) {
      const long double t = centre == Centre::kOne ? 1.0L - std::cos(static_cast<long double>(w))
                                                   : 1.0L + std::cos(static_cast<long double>(w));
      const double expected = std::norm(evaluate(p, std::polar(1.0, w)));
      EXPECT_NEAR(static_cast<double>(evaluate(square, t)), expected, 1e-12) << w;
      EXPECT_NEAR(static_cast<double>(squared_modulus_at(b, centre, t)), expected, 1e-12) << w;
    }
  }
}

TEST(CirclePolynomial, SquaredModulusAtKeepsItsDigitsNextToAZero) {
  const double radius = 1.0 - 1e-7;
  Polynomial p = Polynomial::Ones(1);
  for (int i = 0; i < 3; ++i) p = multiply(p, Eigen::Vector3d(1.0, -2.0 * radius * std::cos(2.0), radius * radius));
  const long double t = 1.0L + std::cos(2.0L);
  // |z - r e^{2j}|^2 |z - r e^{-2j}|^2 at z = e^{2j}.
  const double factor = 1e-14 * std::norm(std::polar(1.0, 2.0) - std::polar(radius, -2.0));
  const auto value = static_cast<double>(squared_modulus_at(taylor(p, Centre::kMinusOne), Centre::kMinusOne, t));
  EXPECT_GT(value, 0.0);
  EXPECT_NEAR(std::log10(value), 3.0 * std::log10(factor), 10.0);  // the coefficients hold no more than that
}

TEST(CirclePolynomial, SignChangesFindEverySimpleZeroToTheLastDigit) {
  const std::vector<long double> zeros{0.1L, 0.25L, 0.2500001L, 0.7L, 0.99L};
  const std::vector<long double> found = sign_changes(with_zeros(zeros), 0.0L, 1.0L);
  ASSERT_EQ(found.size(), zeros.size());
  for (std::size_t i = 0; i < zeros.size(); ++i) {
    EXPECT_NEAR(static_cast<double>(found[i]), static_cast<double>(zeros[i]), 1e-10);
  }
}

TEST(CirclePolynomial, SignChangesPassOverDoubleZerosAndCountTripleOnesOnce) {
  EXPECT_TRUE(sign_changes(with_zeros({0.5L, 0.5L}), 0.0L, 1.0L).empty());
  const std::vector<long double> triple = sign_changes(with_zeros({0.5L, 0.5L, 0.5L}), 0.0L, 1.0L);
  ASSERT_EQ(triple.size(), 1u);
  EXPECT_NEAR(static_cast<double>(triple[0]), 0.5, 1e-6);
}

TEST(CirclePolynomial, SignChangesLeaveOutWhatLiesBeyondTheInterval) {
  EXPECT_TRUE(sign_changes(with_zeros({-0.5L, 1.5L}), 0.0L, 1.0L).empty());
  EXPECT_TRUE(sign_changes({3.0L}, 0.0L, 1.0L).empty());
  EXPECT_TRUE(sign_changes({0.0L, 0.0L}, 0.0L, 1.0L).empty());
}

TEST(CirclePolynomial, ZeroAtTheOriginIsDividedOut) {
  EXPECT_EQ(without_zero_at_origin({0.0L, 2.0L, 3.0L}), (CirclePolynomial{2.0L, 3.0L}));
  EXPECT_EQ(without_zero_at_origin({0.0L}), CirclePolynomial{0.0L});
}

}  // namespace
}  // namespace platoon
