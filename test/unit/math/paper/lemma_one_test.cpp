#include "unit/math/paper/lemma_one.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "stochastic_platoon/math/string/stationary_variance.hpp"
#include "unit/math/example_loops.hpp"

namespace platoon {
namespace {

TEST(LemmaOne, AgreesWithTheMomentsFromStructure) {
  for (const ExampleLoop& example : example_loops()) {
    const PlatoonModel model = model_with(example.loop, example.headway);
    const SignalMoments structure = error_moments(model, 4, 60);
    const SignalMoments dense = error_moments_by_lemma_one(model, 4, 60);
    double scale = 0.0;
    for (const double mean : dense.mean) scale = std::max(scale, std::abs(mean));
    for (std::size_t at = 0; at < dense.mean.size(); ++at) {
      EXPECT_NEAR(structure.mean[at], dense.mean[at], 1e-12 * scale) << example.name << " at " << at;
      EXPECT_NEAR(structure.variance[at], dense.variance[at], 1e-10 * dense.variance[at])
          << example.name << " at " << at;
    }
  }
}

TEST(LemmaOne, SolvesTheLyapunovEquationWithoutAResidual) {
  const StringMatrices string = string_matrices(paper_loop(3.2).realization, 3.2, 6);
  const Eigen::MatrixXd q = noise_covariance(string, 0.6);
  const Eigen::MatrixXd p = solve_discrete_lyapunov(string.a, q);
  EXPECT_LT((p - string.a * p * string.a.transpose() - q).cwiseAbs().maxCoeff(), 1e-13 * p.cwiseAbs().maxCoeff());
}

TEST(LemmaOne, HasTheSameStationaryCovarianceByBothFormulas) {
  const StringMatrices string = string_matrices(paper_loop(2.4).realization, 2.4, 4);
  const Eigen::MatrixXd vec = stationary_covariance_by_vec(string, 0.6);
  const Eigen::MatrixXd lyapunov = stationary_covariance_by_lyapunov(string, 0.6);
  EXPECT_LT((vec - lyapunov).cwiseAbs().maxCoeff(), 1e-12 * vec.cwiseAbs().maxCoeff());
}

TEST(LemmaOne, RejectsSystemsWithoutAStationaryCovariance) {
  const TransferFunction t = ramp_tracking(polynomial_with_zeros({1.01, 0.2}), 2.0);
  const StringMatrices string = string_matrices(observable_canonical(t), 2.0, 2);
  EXPECT_THROW(stationary_covariance_by_vec(string, 0.6), std::invalid_argument);
  EXPECT_THROW(stationary_covariance_by_lyapunov(string, 0.6), std::invalid_argument);
}

TEST(LemmaOne, KeepsItsDigitsForLongStrings) {
  const PlatoonModel model = model_with(paper_loop(3.2), 3.2);
  const StringMatrices string = string_matrices(model.default_vehicle().loop.realization, 3.2, 40);
  // The computed eigenvalues of this A, of multiplicity 40, are unreliable: rho(A) = 0.527.
  EXPECT_GT(string.a.eigenvalues().cwiseAbs().maxCoeff(), 0.6);
  const double expected = stationary_variances(model, 40).back();
  EXPECT_NEAR(stationary_covariance_by_lyapunov(string, 0.6)(39, 39), expected, 1e-11 * expected);
}

TEST(LemmaOne, RejectsAnEmptyStringAndAnEmptyRun) {
  const PlatoonModel model = model_with(paper_loop(3.2), 3.2);
  EXPECT_THROW(error_moments_by_lemma_one(model, 0, 5), std::invalid_argument);
  EXPECT_THROW(error_moments_by_lemma_one(model, 2, 0), std::invalid_argument);
}

}  // namespace
}  // namespace platoon
