#include "stochastic_platoon/math/numerics/krylov.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "stochastic_platoon/math/numerics/eigenvalues.hpp"

namespace platoon {
namespace {

Eigen::MatrixXd nonnegative(Eigen::Index size, double radius) {
  std::mt19937 random(static_cast<unsigned>(size));
  std::uniform_real_distribution<double> entry(0.0, 1.0);
  Eigen::MatrixXd matrix(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = 0; j < size; ++j) matrix(i, j) = entry(random);
  }
  return matrix * (radius / spectral_radius(matrix));
}

NonnegativeMap map_of(const Eigen::MatrixXd& matrix) {
  return [matrix](const Eigen::VectorXd& x) -> Eigen::VectorXd { return matrix * x; };
}

TEST(Krylov, FindsThePerronRoot) {
  for (const Eigen::Index size : {1, 2, 7, 60, 200}) {
    EXPECT_NEAR(perron_root(map_of(nonnegative(size, 0.75)), size), 0.75, 1e-12) << size;
  }
  EXPECT_EQ(perron_root(map_of(Eigen::MatrixXd::Zero(3, 3)), 3), 0.0);
  EXPECT_EQ(perron_root(map_of(Eigen::MatrixXd()), 0), 0.0);
}

TEST(Krylov, FindsThePerronRootToAShareOfItsDistanceFromOne) {
  const Eigen::Index size = 200;
  const auto products_for = [&](double root, double share) {
    int products = 0;
    const NonnegativeMap map = map_of(nonnegative(size, root));
    const auto counted = [&](const Eigen::VectorXd& x) {
      ++products;
      return map(x);
    };
    EXPECT_NEAR(perron_root(counted, size, share), root, std::max(share * (1.0 - root), 1e-13)) << share;
    return products;
  };
  EXPECT_LT(products_for(0.75, 1e-4), products_for(0.75, 0.0));
  products_for(1.0 - 1e-9, 1e-4);
}

// Nearly nilpotent: the computed eigenvalues of the unbalanced matrix are rounding errors of its largest entry.
TEST(Krylov, FindsThePerronRootOfComponentsOfManyOrdersOfMagnitude) {
  const Eigen::Index size = 12;
  const Eigen::MatrixXd even = nonnegative(size, 1e-5);
  Eigen::VectorXd units(size);
  for (Eigen::Index i = 0; i < size; ++i) units(i) = std::pow(10.0, static_cast<double>((7 * i) % size));
  const Eigen::MatrixXd uneven = units.asDiagonal() * even * units.cwiseInverse().asDiagonal();
  EXPECT_NEAR(perron_root(map_of(uneven), size), 1e-5, 1e-16);
  const Eigen::VectorXd b = Eigen::VectorXd::Ones(size);
  const Eigen::VectorXd x = solve_one_minus(map_of(uneven), b);
  Eigen::VectorXd sum = b, term = b;  // its Neumann series, of positive terms
  for (int k = 0; k < 10; ++k) sum += term = uneven * term;
  for (Eigen::Index i = 0; i < size; ++i) EXPECT_NEAR(x(i), sum(i), 1e-13 * sum(i)) << i;
}

// Its Krylov space from ones is invariant after one dimension.
TEST(Krylov, FindsThePerronRootOfEqualRowSums) {
  EXPECT_NEAR(perron_root(map_of(Eigen::MatrixXd::Constant(5, 5, 0.1)), 5), 0.5, 1e-14);
}

TEST(Krylov, FindsTheEigenvectorOfThePerronRoot) {
  for (const Eigen::Index size : {2, 60, 200}) {
    const Eigen::MatrixXd matrix = nonnegative(size, 0.75);
    const Eigen::VectorXd x = perron_vector(map_of(matrix), size);
    EXPECT_LT((matrix * x - 0.75 * x).norm(), 1e-7 * x.norm()) << size;
  }
}

TEST(Krylov, EnclosesThePerronRoot) {
  for (const Eigen::Index size : {1, 7, 200}) {
    const RootBounds bounds = perron_bounds(map_of(nonnegative(size, 0.75)), size);
    EXPECT_LE(bounds.least, 0.75 * (1.0 + 1e-12)) << size;
    EXPECT_GE(bounds.most, 0.75 * (1.0 - 1e-12)) << size;
    EXPECT_LT(bounds.most - bounds.least, 0.5) << size;
  }
  EXPECT_EQ(perron_bounds(map_of(Eigen::MatrixXd::Zero(3, 3)), 3).most, 0.0);
}

TEST(Krylov, SolvesWithoutAResidual) {
  for (const Eigen::Index size : {1, 5, 60, 200}) {
    const Eigen::MatrixXd matrix = nonnegative(size, 0.95);
    const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(size, 1.0, 2.0);
    const Eigen::VectorXd x = solve_one_minus(map_of(matrix), b);
    EXPECT_LT((x - matrix * x - b).norm(), 1e-12 * x.norm()) << size;
  }
  EXPECT_EQ(solve_one_minus(map_of(nonnegative(2, 0.5)), Eigen::VectorXd::Zero(2)).norm(), 0.0);
}

}  // namespace
}  // namespace platoon
