#include "stochastic_platoon/math/numerics/resolvent_terms.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>
#include <vector>

namespace platoon {
namespace {

/// y M (I - y M)^-1 x by its terms and directly: the largest difference, relative, over frequencies.
double difference(const Eigen::MatrixXd& transition) {
  const Eigen::MatrixXd matrix = transition.transpose();
  const Eigen::Index n = matrix.rows();
  const std::vector<ResolventTerm> terms = memory_terms(matrix);
  double worst = 0.0;
  for (int k = 1; k <= 40; ++k) {  // at y = 1 the matrix is singular
    const std::complex<double> y = std::polar(1.0, 0.15 * k);
    const Eigen::MatrixXcd moved = y * matrix.cast<std::complex<double>>();
    const auto inverse = (Eigen::MatrixXcd::Identity(n, n) - moved).partialPivLu();
    for (Eigen::Index j = 1; j < n; ++j) {
      Eigen::VectorXcd x = Eigen::VectorXcd::Zero(n), sum = Eigen::VectorXcd::Zero(n);
      x(0) = 1.0;
      x(j) = -1.0;
      for (const ResolventTerm& term : terms)
        sum += term.left * (term.right * x) * (y * term.eigenvalue / (1.0 - y * term.eigenvalue));
      const Eigen::VectorXcd direct = inverse.solve(moved * x);
      worst = std::max(worst, (sum - direct).norm() / (1e-3 + direct.norm()));
    }
  }
  return worst;
}

Eigen::MatrixXd matrix_of(Eigen::Index n, const std::vector<double>& rows) {
  return Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(rows.data(), n, n);
}

TEST(MemoryTerms, AreTheResolventOfTheChain) {
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int model = 0; model < 50; ++model) {
    const Eigen::Index n = 2 + model % 5;
    Eigen::MatrixXd p(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = 0; j < n; ++j) p(i, j) = uniform(generator);
      p.row(i) /= p.row(i).sum();
    }
    EXPECT_LT(difference(p), 1e-12) << p;
  }
}

// Pairs of independent bits remember two steps and no more: 0 is an eigenvalue without eigenvectors.
TEST(MemoryTerms, AreTheResolventOfAChainWithoutAccurateEigenvectors) {
  EXPECT_LT(difference(matrix_of(4, {0.7, 0.3, 0.0, 0.0, 0.0, 0.0, 0.7, 0.3, 0.7, 0.3, 0.0, 0.0, 0.0, 0.0, 0.7, 0.3})),
            1e-12);
  EXPECT_LT(difference(matrix_of(3, {0.6, 0.4, 0.0, 0.1, 0.6, 0.3, 0.3, 0.1, 0.6})), 1e-12);
  EXPECT_LT(difference(matrix_of(3, {0.75, 0.25, 0.0, 0.0, 0.75, 0.25, 0.25 * 0.25, 0.0, 1.0 - 0.25 * 0.25})), 1e-12);
}

TEST(MemoryTerms, AreNoneOfIndependentLosses) {
  EXPECT_TRUE(memory_terms(matrix_of(2, {0.9, 0.1, 0.9, 0.1}).transpose()).empty());
}

}  // namespace
}  // namespace platoon
