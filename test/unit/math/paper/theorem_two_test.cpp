#include "stochastic_platoon/math/paper/theorem_two.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "stochastic_platoon/math/paper/norms.hpp"
#include "stochastic_platoon/math/paper/string_matrices.hpp"
#include "stochastic_platoon/math/string/error_moments.hpp"
#include "unit/math/example_loops.hpp"

namespace platoon {
namespace {

/// The same T in controllable companion form, the dual of the form that close_loop gives.
StateSpace controllable(const StateSpace& loop) {
  return {loop.a().transpose(), loop.c().transpose(), loop.b().transpose()};
}

/// max over k and i of ||eta_i C A^k||^2, by the dense matrices.
double dense_covariance_gain(const StateSpace& loop, double headway, std::size_t followers, int steps) {
  const StringMatrices string = string_matrices(loop, headway, followers);
  Eigen::MatrixXd rows = string.c;
  double largest = 0.0;
  for (int k = 0; k < steps; ++k) {
    largest = std::max(largest, rows.rowwise().squaredNorm().maxCoeff());
    rows = (rows * string.a).eval();
  }
  return largest;
}

TEST(TheoremTwo, BoundsEveryFollowerAtEveryStep) {
  for (const ExampleLoop& example : string_stable_loops()) {
    if (example.name.find("slow") != std::string::npos) continue;  // any effect takes thousands of steps
    const PlatoonModel model = model_with(example.loop, example.headway);
    for (const std::size_t followers : {1u, 2u, 20u}) {
      const TheoremTwoBounds bounds = theorem_two_bounds(model, followers, 300);
      ASSERT_TRUE(bounds.mean_bound && bounds.variance_bound) << example.name;
      const ErrorNorms norms = error_norms(error_moments(model, followers, 300), NormOrder::kTwo, NormOrder::kInfinity);
      for (std::size_t i = 0; i < followers; ++i) {
        EXPECT_LE(norms.mean[i], *bounds.mean_bound * (1.0 + 1e-12)) << example.name << " " << i + 1;
        EXPECT_LE(norms.variance[i], *bounds.variance_bound * (1.0 + 1e-12)) << example.name << " " << i + 1;
      }
    }
  }
}

TEST(TheoremTwo, ExceedsTheStatedBoundOfTheInitialVariance) {
  // P_xi(0) = I. The paper's bound is rho(P) ||C||^2, the value at k = 0.
  const StateSpace companion = controllable(paper_loop(3.2).realization);
  const double stated = companion.c().squaredNorm();
  EXPECT_NEAR(initial_covariance_gain(companion, 20) / stated, 1.6795, 1e-4);
  const StateSpace observable = paper_loop(3.2).realization;
  EXPECT_EQ(observable.c().squaredNorm(), 1.0);
  EXPECT_NEAR(initial_covariance_gain(observable, 20), 2.7738, 1e-4);
  EXPECT_NEAR(initial_covariance_gain(observable, 1), 2.6705, 1e-4);
}

TEST(TheoremTwo, HasTheCovarianceGainOfTheDenseString) {
  for (const double h : {3.2, 2.4}) {
    const StateSpace loop = paper_loop(h).realization;
    for (const std::size_t followers : {1u, 3u, 40u}) {
      for (const StateSpace& form : {loop, controllable(loop)}) {
        const double expected = dense_covariance_gain(form, h, followers, 300);
        EXPECT_NEAR(initial_covariance_gain(form, followers), expected, 1e-12 * expected) << h << " " << followers;
      }
    }
  }
}

TEST(TheoremTwo, HasTheMeanGainOfTheWorstInitialState) {
  const StateSpace loop = paper_loop(3.2).realization;
  const StringMatrices string = string_matrices(loop, 3.2, 4);
  Eigen::MatrixXd observed(400, string.a.rows());
  Eigen::RowVectorXd row = string.c.bottomRows(1);
  for (Eigen::Index k = 0; k < observed.rows(); ++k) {
    observed.row(k) = row;
    row = (row * string.a).eval();
  }
  const double expected = Eigen::JacobiSVD<Eigen::MatrixXd>(observed).singularValues()(0);
  EXPECT_NEAR(initial_mean_gain(loop, 3.2, 4), expected, 1e-10 * expected);
}

TEST(TheoremTwo, HasAMeanGainThatGrowsBelowThatOfAnyLength) {
  for (const ExampleLoop& example : string_stable_loops()) {
    const StateSpace& loop = example.loop.realization;
    double before = 0.0;
    for (const std::size_t followers : {1u, 2u, 5u, 15u}) {
      const double gain = initial_mean_gain(loop, example.headway, followers);
      EXPECT_GE(gain, before * (1.0 - 1e-6)) << example.name;
      EXPECT_LE(gain, initial_mean_gain_of_any_length(loop) * (1.0 + 1e-6)) << example.name;
      before = gain;
    }
  }
}

TEST(TheoremTwo, HasTheSupremumOfTheInitialCovarianceOverAllLengths) {
  std::vector<ExampleLoop> loops = example_loops();
  for (const ExampleLoop& loop : string_stable_loops()) loops.push_back(loop);
  Eigen::Matrix3d basis;  // coordinates in which the worst pattern of positions differs between vehicles
  basis << -2.0, -1.0, 0.0, 2.0, 1.0, 1.0, -3.0, -2.0, -2.0;
  const Eigen::Matrix3d inverse = basis.inverse();
  const StateSpace paper = paper_loop(3.2).realization;
  const StateSpace turned(basis * paper.a() * inverse, basis * paper.b(), paper.c() * inverse);
  loops.push_back({"paper, turned", 3.2, closed_loop_from(turned)});
  for (const ExampleLoop& example : loops) {
    const PlatoonModel model = model_with(example.loop, example.headway);
    const double bound = theorem_two_bounds(model, 2, 10).initial_covariance;
    double largest = 0.0;
    for (const std::size_t followers : {1u, 2u, 3u, 50u}) {
      const Eigen::MatrixXd response = initial_string(model, followers).response;
      const Eigen::MatrixXd gram = response.transpose() * response;
      largest = 0.3 * Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(gram).eigenvalues().maxCoeff();
      EXPECT_LE(largest, bound * (1.0 + 1e-12)) << example.name << " " << followers;
    }
    EXPECT_NEAR(largest, bound, 1e-2 * bound) << example.name;
  }
}

TEST(TheoremTwo, BoundsVeryLongStringsForAnyLength) {
  const PlatoonModel model = model_with(paper_loop(3.2), 3.2);
  const TheoremTwoBounds some = theorem_two_bounds(model, 60, 200);
  const TheoremTwoBounds many = theorem_two_bounds(model, 100000, 200);
  EXPECT_GT(*many.beta_1, *some.beta_1);
  EXPECT_GT(*many.beta_2, *some.beta_2);
  EXPECT_EQ(many.alpha_1, some.alpha_1);
  EXPECT_EQ(many.alpha_2, some.alpha_2);
}

TEST(TheoremTwo, HasTheTermsOfThePaper) {
  const PlatoonModel model = model_with(paper_loop(3.2), 3.2);
  const TheoremTwoBounds bounds = theorem_two_bounds(model, 20, 300);
  const std::vector<double> leader = leader_error(model, 300);
  EXPECT_EQ(bounds.leader_norm, sequence_norm(leader.data(), leader.size(), NormOrder::kTwo));
  EXPECT_EQ(*bounds.alpha_1, bounds.leader_norm);  // ||T||_infinity = 1
  EXPECT_NEAR(bounds.initial_mean, initial_string(model, 20).mean.norm(), 1e-14);
  EXPECT_EQ(*bounds.beta_1, initial_mean_gain(model.default_vehicle().loop.realization, 3.2, 20) * bounds.initial_mean);
  EXPECT_EQ(*bounds.beta_2,
            initial_covariance_gain(model.default_vehicle().loop.realization, 20) * bounds.initial_covariance);
  EXPECT_EQ(*bounds.stated_beta_2, bounds.initial_covariance);  // ||C|| = 1
  EXPECT_EQ(*bounds.variance_bound, *bounds.alpha_2 + *bounds.beta_2);
}

TEST(TheoremTwo, HasNoBoundsForAStringUnstablePlatoon) {
  const TheoremTwoBounds bounds = theorem_two_bounds(model_with(paper_loop(2.4), 2.4), 20, 100);
  EXPECT_FALSE(bounds.alpha_1 || bounds.beta_1 || bounds.mean_bound);
  EXPECT_FALSE(bounds.alpha_2 || bounds.beta_2 || bounds.stated_beta_2 || bounds.variance_bound);
}

TEST(TheoremTwo, RejectsUnstableVehiclesAndEmptyStrings) {
  const StateSpace loop = paper_loop(3.2).realization;
  const StateSpace unstable(Eigen::MatrixXd::Identity(1, 1), Eigen::VectorXd::Ones(1), Eigen::RowVectorXd::Ones(1));
  EXPECT_THROW(initial_mean_gain(unstable, 1.0, 2), std::invalid_argument);
  EXPECT_THROW(initial_mean_gain(loop, 3.2, 0), std::invalid_argument);
  EXPECT_THROW(initial_covariance_gain(unstable, 2), std::invalid_argument);
  EXPECT_THROW(initial_covariance_gain(loop, 0), std::invalid_argument);
  EXPECT_THROW(theorem_two_bounds(model_with(paper_loop(3.2), 3.2), 0, 10), std::invalid_argument);
  EXPECT_THROW(theorem_two_bounds(model_with(paper_loop(3.2), 3.2), 2, 0), std::invalid_argument);
}

TEST(TheoremTwo, EnclosesACovarianceGainWithinALimitOfTime) {
  for (const double h : {20.0, 200.0}) {
    const StateSpace loop = paper_loop(h).realization;
    const double gain = initial_covariance_gain(loop, 5);
    const GainEnclosure found = initial_covariance_gain_within(loop, 5, 1e4);
    EXPECT_LE(found.from, gain) << h;
    EXPECT_GE(found.to, gain) << h;
    EXPECT_EQ(initial_covariance_gain_within(loop, 5, 1e9).from, gain);
  }
}

// A million steps and more: computing each of them would take hours.
TEST(TheoremTwo, BoundsAVerySlowLoopWithoutDelay) {
  const double h = 1048576.0;
  const StateSpace slow(Eigen::MatrixXd::Constant(1, 1, h / (1.0 + h)), Eigen::VectorXd::Constant(1, 1.0 / (1.0 + h)),
                        Eigen::RowVectorXd::Ones(1));
  for (const double variance : {0.0, 1.0}) {
    PlatoonModel model = model_with(closed_loop_from(slow), h);
    model.default_vehicle().initial_position.variance = variance;
    const TheoremTwoBounds bounds = theorem_two_bounds(model, 20, 100);
    ASSERT_TRUE(bounds.beta_2);
    EXPECT_GE(*bounds.beta_2, bounds.initial_covariance);
    if (variance == 0.0) {
      EXPECT_EQ(*bounds.beta_2, 0.0);
    }
  }
}

// The unit of the state has no effect, even if ||C||^2 is beyond the range of double.
TEST(TheoremTwo, DoesNotDependOnTheUnitOfTheState) {
  const StateSpace loop = paper_loop(3.2).realization;
  const TheoremTwoBounds expected = theorem_two_bounds(model_with(closed_loop_from(loop), 3.2), 5, 100);
  for (const int exponent : {-600, -40, 40, 600}) {
    const StateSpace scaled(loop.a(), loop.b() * std::ldexp(1.0, -exponent), loop.c() * std::ldexp(1.0, exponent));
    const TheoremTwoBounds found = theorem_two_bounds(model_with(closed_loop_from(scaled), 3.2), 5, 100);
    EXPECT_NEAR(*found.mean_bound, *expected.mean_bound, 1e-12 * *expected.mean_bound) << exponent;
    EXPECT_NEAR(*found.variance_bound, *expected.variance_bound, 1e-12 * *expected.variance_bound) << exponent;
  }
}

}  // namespace
}  // namespace platoon
