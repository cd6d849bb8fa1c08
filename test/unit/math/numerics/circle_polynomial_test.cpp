#include "stochastic_platoon/math/numerics/circle_polynomial.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "stochastic_platoon/math/numerics/delta_form.hpp"

namespace platoon {
namespace {

Polynomial sample_polynomial() {
  Polynomial p(6);
  p << 2.0, -1.5, 0.25, 3.0, -0.5, 0.75;
  return p;
}

/// Coefficients of p(z) by powers of z - 1 or z + 1.
CirclePolynomial taylor(const Polynomial& p, Centre centre) {
  return centre == Centre::kOne ? delta_form(p) : recentred(delta_form(p));
}

/// The product of (t - zero).
CirclePolynomial with_zeros(const std::vector<long double>& zeros) {
  CirclePolynomial p{1.0L};
  for (const long double zero : zeros) p = multiply(p, {-zero, 1.0L});
  return p;
}

TEST(CirclePolynomial, HasACoordinateForEveryFrequency) {
  for (const double w : {0.0, 1e-9, 1e-3, 1.0, 1.5, 2.0, 3.0, 3.14159265, 3.141592653589793}) {
    const Centre centre = w < 1.57 ? Centre::kOne : Centre::kMinusOne;
    EXPECT_NEAR(frequency_at(circle_coordinate(w, centre), centre), w, 1e-15 * w) << w;
  }
}

TEST(CirclePolynomial, EqualsItsTaylorExpansion) {
  const Polynomial p = sample_polynomial();
  for (const Centre centre : {Centre::kOne, Centre::kMinusOne}) {
    const CirclePolynomial b = taylor(p, centre);
    const double c = centre == Centre::kOne ? 1.0 : -1.0;
    for (const double z : {-2.0, -0.3, 0.0, 1.7}) {
      EXPECT_NEAR(static_cast<double>(evaluate(b, z - c)), evaluate(p, z).real(), 1e-13);
    }
  }
}

TEST(CirclePolynomial, HasTheSquaredModulusOnTheUnitCircle) {
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

TEST(CirclePolynomial, KeepsTheDigitsOfTheSquaredModulusNextToAZero) {
  const std::complex<double> close = std::polar(1.0 - 1e-5, 2.0);
  Polynomial p = Eigen::Vector3d(1.0, -2.0 * close.real(), std::norm(close));
  const std::vector<double> others{0.9, 0.8, 0.1, -0.4};
  for (const double zero : others) p = multiply(p, Eigen::Vector2d(1.0, -zero));
  const std::complex<double> z = std::polar(1.0, 2.0);
  double exact = 1e-10 * std::norm(z - std::conj(close));
  for (const double zero : others) exact *= std::norm(z - zero);
  const long double t = 1.0L + std::cos(2.0L);
  const CirclePolynomial b = taylor(p, Centre::kMinusOne);
  EXPECT_NEAR(static_cast<double>(squared_modulus_at(b, Centre::kMinusOne, t)), exact, 1e-9 * exact);
}

TEST(CirclePolynomial, ChangesItsSignAtEverySimpleZero) {
  const std::vector<long double> zeros{0.1L, 0.25L, 0.2500001L, 0.7L, 0.99L};
  const std::vector<long double> found = sign_changes(with_zeros(zeros), 0.0L, 1.0L);
  ASSERT_EQ(found.size(), zeros.size());
  for (std::size_t i = 0; i < zeros.size(); ++i) {
    EXPECT_NEAR(static_cast<double>(found[i]), static_cast<double>(zeros[i]), 1e-10);
  }
}

TEST(CirclePolynomial, ChangesItsSignAtTripleZerosButNotAtDoubleOnes) {
  EXPECT_TRUE(sign_changes(with_zeros({0.5L, 0.5L}), 0.0L, 1.0L).empty());
  const std::vector<long double> triple = sign_changes(with_zeros({0.5L, 0.5L, 0.5L}), 0.0L, 1.0L);
  ASSERT_EQ(triple.size(), 1u);
  EXPECT_NEAR(static_cast<double>(triple[0]), 0.5, 1e-6);
}

TEST(CirclePolynomial, HasNoSignChangeBeyondTheInterval) {
  EXPECT_TRUE(sign_changes(with_zeros({-0.5L, 1.5L}), 0.0L, 1.0L).empty());
  EXPECT_TRUE(sign_changes({3.0L}, 0.0L, 1.0L).empty());
  EXPECT_TRUE(sign_changes({0.0L, 0.0L}, 0.0L, 1.0L).empty());
}

TEST(CirclePolynomial, IsDividedByItsZeroAtTheOrigin) {
  EXPECT_EQ(without_zero_at_origin({0.0L, 2.0L, 3.0L}), (CirclePolynomial{2.0L, 3.0L}));
  EXPECT_EQ(without_zero_at_origin({0.0L}), CirclePolynomial{0.0L});
}

}  // namespace
}  // namespace platoon
