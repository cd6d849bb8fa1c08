#include "stochastic_platoon/math/model/transfer_function.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

#include "unit/math/model/fractions.hpp"

namespace platoon {
namespace {

Eigen::Index order(const TransferFunction& f) {
  return f.denominator().size() - 1;
}

TEST(TransferFunction, IsTrimmedAndItsDenominatorMonic) {
  const TransferFunction f(Eigen::Vector3d(0.0, 4.0, 2.0), Eigen::Vector4d(0.0, 2.0, 0.0, 1.0));
  EXPECT_EQ(f.numerator(), Eigen::Vector2d(2.0, 1.0));
  EXPECT_EQ(f.denominator(), Eigen::Vector3d(1.0, 0.0, 0.5));
}

TEST(TransferFunction, RejectsADenominatorOfZeroAndInfiniteCoefficients) {
  const Eigen::Vector2d one(0.0, 1.0);
  EXPECT_THROW(TransferFunction(one, Eigen::Vector2d(0.0, 0.0)), std::invalid_argument);
  EXPECT_THROW(TransferFunction(one, Polynomial()), std::invalid_argument);
  EXPECT_THROW(TransferFunction(Eigen::Vector2d(1.0, std::nan("")), one), std::invalid_argument);
  EXPECT_THROW(TransferFunction(one, Eigen::Vector2d(1.0, HUGE_VAL)), std::invalid_argument);
}

TEST(TransferFunction, HasItsRelativeDegree) {
  const Polynomial cubic = Eigen::Vector4d(1.0, 0.0, 0.0, 0.5);
  EXPECT_EQ(TransferFunction(Eigen::Vector2d(2.0, 1.0), cubic).relative_degree(), 2);
  EXPECT_TRUE(TransferFunction(Eigen::Vector2d(2.0, 1.0), cubic).is_strictly_proper());
  EXPECT_EQ(TransferFunction(cubic, cubic).relative_degree(), 0);
  EXPECT_FALSE(TransferFunction(cubic, cubic).is_strictly_proper());
  EXPECT_EQ(TransferFunction(cubic, Eigen::Vector2d(1.0, 0.0)).relative_degree(), -2);
  EXPECT_EQ(TransferFunction(Polynomial::Zero(1), cubic).relative_degree(), 4);
}

TEST(TransferFunction, IsTheQuotientOfItsPolynomials) {
  const TransferFunction f(Eigen::Vector2d(3.0, 1.0), Eigen::Vector2d(2.0, -1.0));
  const std::complex<double> z(0.3, 0.8);
  EXPECT_LT(std::abs(f(z) - (3.0 * z + 1.0) / (2.0 * z - 1.0)), 1e-15);
  EXPECT_FALSE(std::isfinite(std::abs(f(0.5))));
}

TEST(TransferFunction, OfTheHeadwayPolicyIsOnePlusHMinusHOverZ) {
  const TransferFunction h = headway_policy(3.2);
  const std::complex<double> z(0.3, 0.8);
  EXPECT_LT(std::abs(h(z) - (4.2 - 3.2 / z)), 1e-14);
  EXPECT_NEAR(h(1.0).real(), 1.0, 1e-15);
}

TEST(TransferFunction, FollowsTheFormulasOfSeriesAndFeedback) {
  std::mt19937 generator(1);
  const TransferFunction f(random_polynomial(2, generator), random_polynomial(3, generator));
  const TransferFunction r(random_polynomial(1, generator), random_polynomial(2, generator));
  const TransferFunction chain = series(f, r);
  const TransferFunction loop = feedback(f, r);
  for (const std::complex<double>& z : {std::complex<double>(1.0), {0.1, 1.3}, {-2.0, 0.5}}) {
    EXPECT_LT(std::abs(chain(z) - f(z) * r(z)), 1e-13 * std::abs(chain(z)));
    EXPECT_LT(std::abs(loop(z) - f(z) / (1.0 + f(z) * r(z))), 1e-13 * std::abs(loop(z)));
  }
}

TEST(TransferFunction, RejectsFeedbackWithADenominatorOfZero) {
  const TransferFunction one(Polynomial::Ones(1), Polynomial::Ones(1));
  const TransferFunction minus_one(-Polynomial::Ones(1), Polynomial::Ones(1));
  EXPECT_THROW(feedback(one, minus_one), std::invalid_argument);
}

TEST(Reduce, KeepsAFractionInLowestTerms) {
  std::mt19937 generator(2);
  for (int trial = 0; trial < 200; ++trial) {
    const int degree = 1 + trial % 6;
    const TransferFunction f(0.7 * random_polynomial(degree - 1, generator), random_polynomial(degree, generator));
    const Reduction reduction = reduce(f);
    EXPECT_EQ(reduction.minimal.numerator(), f.numerator());
    EXPECT_EQ(reduction.minimal.denominator(), f.denominator());
    EXPECT_EQ(reduction.common_factor, Polynomial::Ones(1));
  }
}

TEST(Reduce, CancelsRandomCommonFactorsOfEveryOrder) {
  std::mt19937 generator(3);
  for (int trial = 0; trial < 600; ++trial) {
    const int degree = 1 + trial % 5;
    const int common = 1 + trial / 5 % 3;
    const Polynomial factor = random_polynomial(common, generator);
    const Polynomial d = random_polynomial(degree, generator);
    const Polynomial n = -0.37 * random_polynomial(static_cast<int>(generator()) % 2 == 0 ? degree - 1 : 0, generator);
    const Reduction reduction = reduce({multiply(n, factor), multiply(d, factor)});
    ASSERT_EQ(order(reduction.minimal), degree);
    ASSERT_EQ(reduction.minimal.numerator().size(), n.size());
    EXPECT_LT(distance(reduction.minimal, {n, d}), 1e-9);
    ASSERT_EQ(reduction.common_factor.size(), factor.size());
    EXPECT_LT((reduction.common_factor - factor).norm(), 1e-6 * factor.norm());
  }
}

TEST(Reduce, CancelsZerosAtTheOriginExactly) {
  const Polynomial n = Eigen::Vector4d(2.0, 1.0, 0.0, 0.0);
  Polynomial d(6);
  d << 1.0, 0.3, 0.2, 0.1, 0.0, 0.0;
  const Reduction reduction = reduce({n, d});
  EXPECT_EQ(reduction.minimal.numerator(), Eigen::Vector2d(2.0, 1.0));
  EXPECT_EQ(reduction.minimal.denominator(), Eigen::Vector4d(1.0, 0.3, 0.2, 0.1));
  EXPECT_EQ(reduction.common_factor, Eigen::Vector3d(1.0, 0.0, 0.0));
}

TEST(Reduce, CancelsMultipleZeros) {
  const Polynomial n = polynomial_with_zeros({0.5, 0.5, 0.5, -0.2});
  const Polynomial d = polynomial_with_zeros({0.5, 0.5, 0.5, {0.1, 0.6}, 0.3});
  const Reduction reduction = reduce({n, d});
  ASSERT_EQ(order(reduction.minimal), 3);
  EXPECT_LT(distance(reduction.minimal, {polynomial_with_zeros({-0.2}), polynomial_with_zeros({{0.1, 0.6}, 0.3})}),
            1e-9);
  EXPECT_LT((reduction.common_factor - polynomial_with_zeros({0.5, 0.5, 0.5})).norm(), 1e-9);
}

TEST(Reduce, TurnsANumeratorOfZeroIntoZeroOverOne) {
  const Polynomial d = polynomial_with_zeros({0.4, 0.0});
  const Reduction reduction = reduce({Polynomial::Zero(1), d});
  EXPECT_EQ(reduction.minimal.numerator(), Polynomial::Zero(1));
  EXPECT_EQ(reduction.minimal.denominator(), Polynomial::Ones(1));
  EXPECT_EQ(reduction.common_factor, d);
}

// Nothing cancels here: a matrix that is nearly singular without a common factor must not change the function.
TEST(Reduce, KeepsTheValueOfAFractionWithPolesCloseToZeros) {
  for (const double distance_between : {0.1, 0.05, 0.02, 0.01}) {
    for (std::size_t poles = 2; poles <= 6; ++poles) {
      const std::vector<std::complex<double>> all(poles, 0.9), zeros(poles - 1, 0.9 - distance_between);
      const TransferFunction f(polynomial_with_zeros(zeros), polynomial_with_zeros(all));
      EXPECT_LT(distance(reduce(f).minimal, f), 1e-8)
          << poles << " poles at 0.9, " << poles - 1 << " zeros at " << 0.9 - distance_between;
    }
  }
}

// The closed loop of a controller that cancels a pole of its plant: T(1) = 1 holds to rounding before and after the
// reduction.
TEST(Reduce, KeepsTheGainAtOneToRounding) {
  const TransferFunction plant(Polynomial::Constant(1, 0.02), polynomial_with_zeros({1.0, 1.0, 0.8, 0.5}));
  const TransferFunction controller(polynomial_with_zeros({0.8, 0.9}), polynomial_with_zeros({0.1, -0.2}));
  const Reduction reduction = reduce(feedback(series(plant, controller), headway_policy(5.0)));
  ASSERT_GE(reduction.common_factor.size(), 2);
  EXPECT_LT(std::abs(reduction.minimal(1.0) - 1.0), 2e-12);
}

// Factors 1e-9 apart are not common, although the singular values do not separate them: cancelling them would change a
// variance by 1e-8.
TEST(Reduce, KeepsFactorsThatAreOnlyNearlyCommon) {
  for (const double apart : {1e-3, 1e-6, 1e-9, 1e-11, 1e-12}) {
    const TransferFunction f(polynomial_with_zeros({0.4140625 + apart, 0.9}),
                             polynomial_with_zeros({0.4140625, {0.3, 0.5}, 0.2}));
    const Reduction reduction = reduce(f);
    EXPECT_EQ(reduction.common_factor, Polynomial::Ones(1)) << apart;
    EXPECT_EQ(reduction.minimal.denominator(), f.denominator()) << apart;
  }
}

// A numerator that dominates the denominator makes the map numerically singular at degrees below the relative degree,
// where no cofactors exist.
TEST(Reduce, IsDefinedForEveryGain) {
  for (int exponent = 0; exponent <= 300; ++exponent) {
    const TransferFunction open(std::pow(10.0, exponent) * Eigen::Vector2d(1.0, 0.0),
                                multiply(Eigen::Vector3d(1.0, -2.0, 1.0), Eigen::Vector4d(1.0, -0.11, -0.64, 0.2225)));
    const TransferFunction loop = feedback(open, headway_policy(3.2));
    const Reduction reduction = reduce(loop);
    EXPECT_EQ(reduction.minimal.relative_degree(), loop.relative_degree()) << exponent;
  }
}

TEST(TransferFunction, RejectsALeadingCoefficientThatMakesTheOthersOverflow) {
  EXPECT_THROW(TransferFunction(Polynomial::Ones(1), Eigen::Vector2d(1e-310, 1.0)), std::invalid_argument);
  EXPECT_THROW(TransferFunction(Polynomial::Constant(1, 1e300), Eigen::Vector2d(1e-100, 1e-100)),
               std::invalid_argument);
}

}  // namespace
}  // namespace platoon
