#include "stochastic_platoon/math/numerics/polynomial.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "unit/zeros.hpp"

namespace platoon {
namespace {

Polynomial poly(const std::vector<double>& coefficients) {
  return Eigen::Map<const Polynomial>(coefficients.data(), static_cast<Eigen::Index>(coefficients.size()));
}

TEST(Polynomial, IsTrimmedOfItsLeadingZeros) {
  EXPECT_EQ(trimmed(poly({0.0, 0.0, 2.0, 0.0})), poly({2.0, 0.0}));
  EXPECT_EQ(trimmed(poly({3.0})), poly({3.0}));
  EXPECT_EQ(trimmed(poly({0.0, 0.0})), poly({0.0}));
}

TEST(Polynomial, RejectsMissingAndInfiniteCoefficients) {
  EXPECT_THROW(trimmed(Polynomial()), std::invalid_argument);
  EXPECT_THROW(trimmed(poly({1.0, std::nan("")})), std::invalid_argument);
  EXPECT_THROW(trimmed(poly({std::numeric_limits<double>::infinity(), 1.0})), std::invalid_argument);
}

TEST(Polynomial, MultipliesAndAddsByPowers) {
  EXPECT_EQ(multiply(poly({1.0, 2.0}), poly({3.0, 4.0, 5.0})), poly({3.0, 10.0, 13.0, 10.0}));
  EXPECT_EQ(multiply(poly({2.0}), poly({1.0, -1.0})), poly({2.0, -2.0}));
  EXPECT_EQ(add(poly({1.0, 2.0}), poly({3.0, 4.0, 5.0})), poly({3.0, 5.0, 7.0}));
  EXPECT_EQ(add(poly({3.0, 4.0, 5.0}), poly({1.0, 2.0})), poly({3.0, 5.0, 7.0}));
}

TEST(Polynomial, HasADerivative) {
  EXPECT_EQ(derivative(poly({2.0, -3.0, 5.0, 7.0})), poly({6.0, -6.0, 5.0}));
  EXPECT_EQ(derivative(poly({4.0})), poly({0.0}));
}

TEST(Polynomial, IsEvaluatedAtComplexPoints) {
  const std::complex<double> z(0.5, -2.0);
  EXPECT_LT(std::abs(evaluate(poly({2.0, 0.0, -1.0}), z) - (2.0 * z * z - 1.0)), 1e-15);
  EXPECT_EQ(evaluate(poly({3.0}), z), std::complex<double>(3.0));
}

TEST(Polynomial, HasAsManyRootsAsItsDegree) {
  EXPECT_TRUE(roots(poly({5.0})).empty());
  EXPECT_TRUE(roots(poly({0.0, 0.0, 5.0})).empty());
  EXPECT_EQ(roots(poly({0.0, 2.0, 1.0})).size(), 1u);
  EXPECT_EQ(roots(poly({1.0, 0.0, 0.0, 0.0, 0.0})).size(), 4u);
}

TEST(Polynomial, HasItsZerosAsRoots) {
  const std::vector<std::complex<double>> zeros = {0.9, -0.3, {0.2, 0.7}};
  const std::vector<std::complex<double>> found = roots(3.5 * polynomial_with_zeros(zeros));
  ASSERT_EQ(found.size(), 4u);
  for (const std::complex<double> zero : zeros) {
    for (const std::complex<double>& expected : {zero, std::conj(zero)}) {
      EXPECT_TRUE(std::any_of(found.begin(), found.end(), [&](const std::complex<double>& root) {
        return std::abs(root - expected) < 1e-13;
      })) << expected;
    }
  }
}

TEST(Polynomial, CountsItsZerosAtOne) {
  for (int multiplicity = 0; multiplicity <= 4; ++multiplicity) {
    std::vector<std::complex<double>> zeros = {0.3, {0.4, 0.5}};
    for (int j = 0; j < multiplicity; ++j) zeros.emplace_back(1.0);
    EXPECT_EQ(multiplicity_at_one(-7.0 * polynomial_with_zeros(zeros)), multiplicity);
  }
  EXPECT_EQ(multiplicity_at_one(poly({2.0})), 0);
  EXPECT_EQ(multiplicity_at_one(poly({1.0, -1.0 - 1e-6})), 0);
}

}  // namespace
}  // namespace platoon
