#include "stochastic_platoon/math/statistics/normal_crossing.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

namespace platoon {
namespace {

constexpr double kPi = 3.14159265358979323846;

double phi(double a) {
  return 0.5 * std::erfc(-a / std::sqrt(2.0));
}

TEST(ProbabilityBelowZero, IsTheNormalDistributionFarIntoItsTail) {
  EXPECT_EQ(probability_below_zero({0.0, 4.0}), 0.5);
  EXPECT_NEAR(probability_below_zero({-2.0, 4.0}), 0.8413447460685429, 1e-15);
  EXPECT_NEAR(probability_below_zero({20.0, 4.0}) / 7.61985302416052606e-24, 1.0, 1e-13);
}

TEST(ProbabilityBelowZero, OfACertainValueIsZeroOrOne) {
  EXPECT_EQ(probability_below_zero({0.0, 0.0}), 0.0);
  EXPECT_EQ(probability_below_zero({-1e-9, 0.0}), 1.0);
  EXPECT_TRUE(std::isnan(probability_below_zero({std::nan(""), 0.0})));
}

TEST(ProbabilityOfCrossing, OfIndependentValuesIsAProduct) {
  for (const double a : {-3.0, -0.5, 0.0, 1e-9, 0.7, 2.0, 5.0}) {
    for (const double b : {-2.0, -0.5, 0.0, 0.6, 2.0, 6.0}) {
      const double expected = phi(a) * phi(-b);
      EXPECT_NEAR(probability_of_crossing({3.0 * a, 9.0}, {0.5 * b, 0.25}, 9.25) / expected, 1.0, 1e-12)
          << a << " " << b;
    }
  }
}

TEST(ProbabilityOfCrossing, OfCentredValuesIsTheirAngle) {
  for (const double angle : {1e-6, 1e-3, 0.5, 2.0, 3.0}) {
    const double from_one = 2.0 * std::sin(angle / 2.0) * std::sin(angle / 2.0);
    EXPECT_NEAR(probability_of_crossing({0.0, 2.0}, {0.0, 2.0}, 4.0 * from_one) / (angle / (2.0 * kPi)), 1.0, 1e-12);
  }
}

TEST(ProbabilityOfCrossing, OfTheSameOrOppositeValuesFollowsFromOneOfThem) {
  EXPECT_EQ(probability_of_crossing({1.0, 2.0}, {1.0, 2.0}, 0.0), 0.0);
  EXPECT_NEAR(probability_of_crossing({1.0, 1.0}, {0.5, 1.0}, 0.0) / (phi(1.0) - phi(0.5)), 1.0, 1e-13);
  // y = -x: both conditions hold exactly if x > 0.
  EXPECT_NEAR(probability_of_crossing({1.0, 1.0}, {-1.0, 1.0}, 4.0) / phi(1.0), 1.0, 1e-12);
}

// P(x >= 0, y < 0) - P(x < 0, y >= 0) = P(y < 0) - P(x < 0).
TEST(ProbabilityOfCrossing, BalancesBothDirections) {
  const NormalLaw laws[] = {{2.0, 1.5}, {1.9, 1.4}, {-0.3, 0.2}, {4.0, 3.0}, {0.01, 0.7}};
  for (const NormalLaw& x : laws) {
    for (const NormalLaw& y : laws) {
      for (const double correlation : {-0.9, 0.0, 0.6, 0.99}) {
        const double change = x.variance + y.variance - 2.0 * correlation * std::sqrt(x.variance * y.variance);
        const double down = probability_of_crossing(x, y, change),
                     up = probability_of_crossing({-x.mean, x.variance}, {-y.mean, y.variance}, change);
        EXPECT_NEAR(down - up, probability_below_zero(y) - probability_below_zero(x), 1e-14);
        EXPECT_GE(down, 0.0);
      }
    }
  }
}

// References by mpmath in 30 digits.
TEST(ProbabilityOfCrossing, KeepsItsDigitsIfItIsRare) {
  const auto correlated = [](double from_one) { return 2.0 * from_one; };
  EXPECT_NEAR(probability_of_crossing({5.0, 1.0}, {5.0, 1.0}, correlated(1e-4)) / 8.386239305940961e-9, 1.0, 1e-11);
  EXPECT_NEAR(probability_of_crossing({5.0, 1.0}, {5.1, 1.0}, correlated(1e-4)) / 1.712030540173613e-21, 1.0, 1e-11);
  EXPECT_NEAR(probability_of_crossing({5.0, 1.0}, {4.9, 1.0}, correlated(1e-4)) / 1.925317047111288e-7, 1.0, 1e-11);
}

TEST(ProbabilityOfCrossing, OfACertainValueIsThatOfTheOther) {
  EXPECT_EQ(probability_of_crossing({0.0, 0.0}, {-1.0, 1.0}, 1.0), probability_below_zero({-1.0, 1.0}));
  EXPECT_EQ(probability_of_crossing({-1.0, 0.0}, {-1.0, 1.0}, 1.0), 0.0);
  EXPECT_EQ(probability_of_crossing({1.0, 1.0}, {-1.0, 0.0}, 1.0), phi(1.0));
  EXPECT_EQ(probability_of_crossing({1.0, 1.0}, {0.0, 0.0}, 1.0), 0.0);
  EXPECT_TRUE(std::isnan(probability_of_crossing({1.0, std::numeric_limits<double>::infinity()}, {1.0, 1.0}, 1.0)));
}

TEST(MeanNeeded, GivesTheProbability) {
  for (const double probability : {1e-300, 1e-6, 0.1, 0.499})
    EXPECT_NEAR(probability_below_zero({mean_needed(2.5, probability), 2.5}) / probability, 1.0, 1e-11);
  EXPECT_EQ(mean_needed(0.0, 1e-6), 0.0);
}

}  // namespace
}  // namespace platoon
