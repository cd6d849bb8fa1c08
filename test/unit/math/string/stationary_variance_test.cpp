#include "stochastic_platoon/math/string/stationary_variance.hpp"

#include <gtest/gtest.h>
#include <cmath>
#include <stdexcept>

#include "stochastic_platoon/math/string/error_moments.hpp"
#include "stochastic_platoon/math/string/string_stability.hpp"
#include "unit/math/example_loops.hpp"
#include "unit/math/paper/lemma_one.hpp"

namespace platoon {
namespace {

std::vector<ExampleLoop> all_loops() {
  std::vector<ExampleLoop> loops = example_loops();
  for (const ExampleLoop& loop : string_stable_loops()) loops.push_back(loop);
  return loops;
}

/// Loops whose dense solutions keep ten digits. With several slow poles in one companion matrix, and h in the
/// thousands, they do not (7 digits are left), while the structure and the sum over time still agree.
std::vector<ExampleLoop> loops_for_dense_solutions() {
  std::vector<ExampleLoop> loops = example_loops();
  for (const ExampleLoop& loop : string_stable_loops()) {
    if (loop.name.find("slow") == std::string::npos) loops.push_back(loop);
  }
  return loops;
}

TEST(StationaryVariance, AgreesWithTheLyapunovEquationOfTheWholeString) {
  for (const ExampleLoop& example : loops_for_dense_solutions()) {
    const PlatoonModel model = model_with(example.loop, example.headway);
    const std::vector<double> variances = stationary_variances(model, 4);
    const StringMatrices string =
        string_matrices(model.default_vehicle().loop.realization, model.default_vehicle().headway, 4);
    const Eigen::MatrixXd dense =
        stationary_covariance_by_lyapunov(string, model.default_vehicle().position().noise_variance);
    for (std::size_t i = 0; i < 4; ++i) {
      const double expected = dense(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i));
      EXPECT_NEAR(variances[i], expected, 1e-10 * expected) << example.name;
    }
  }
}

TEST(StationaryVariance, AgreesWithTheVecFormulaOfLemmaOne) {
  for (const ExampleLoop& example : loops_for_dense_solutions()) {
    const PlatoonModel model = model_with(example.loop, example.headway);
    const std::size_t followers = example.loop.realization.order() <= 3 ? 3 : 1;
    const std::vector<double> variances = stationary_variances(model, followers);
    const StringMatrices string =
        string_matrices(model.default_vehicle().loop.realization, model.default_vehicle().headway, followers);
    const Eigen::MatrixXd dense =
        stationary_covariance_by_vec(string, model.default_vehicle().position().noise_variance);
    for (std::size_t i = 0; i < followers; ++i) {
      const double expected = dense(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i));
      EXPECT_NEAR(variances[i], expected, 1e-10 * expected) << example.name;
    }
  }
}

TEST(StationaryVariance, EqualsTheVarianceAfterManySteps) {
  for (const ExampleLoop& example : all_loops()) {
    PlatoonModel model = model_with(example.loop, example.headway);
    model.default_vehicle().initial_position = {0.0, 0.0};
    const double rho = spectral_radius(model.default_vehicle().loop.realization);
    const auto steps = static_cast<std::int64_t>(200.0 + 60.0 / (1.0 - rho));
    const SignalMoments moments = error_moments(model, 3, steps);
    const std::vector<double> variances = stationary_variances(model, 3);
    for (std::size_t i = 1; i <= 3; ++i) {
      const double settled = moments.variance_at(i, steps - 1);
      EXPECT_NEAR(variances[i - 1], settled, 1e-10 * settled) << example.name << " " << i;
    }
  }
}

TEST(StationaryVariance, OfAMillionFollowersRisesToTheLimit) {
  for (const ExampleLoop& example : string_stable_loops()) {
    const PlatoonModel model = model_with(example.loop, example.headway);
    const std::size_t followers = example.name == "paper" ? 1000000 : 20000;
    const std::vector<double> variances = stationary_variances(model, followers);
    const double limit = *string_stability(model).limit_variance;
    for (std::size_t i = 1; i < followers; ++i) ASSERT_LE(variances[i - 1], variances[i]) << example.name;
    EXPECT_LE(variances.back(), limit * (1.0 + 1e-13)) << example.name;
    if (example.name == "paper") {
      EXPECT_NEAR(variances.back(), limit, 1e-9 * limit);
    }
  }
}

TEST(StationaryVariance, DoesNotDependOnTheNumberOfFollowers) {
  const PlatoonModel model = model_with(paper_loop(3.2), 3.2);
  const std::vector<double> many = stationary_variances(model, 3000);
  for (const std::size_t followers : {1u, 2u, 256u, 257u, 2999u}) {
    EXPECT_NEAR(stationary_variances(model, followers).back(), many[followers - 1], 1e-13 * many[followers - 1]);
  }
}

TEST(StationaryVariance, OfAStringUnstablePlatoonGrowsByTheSquaredPeakGain) {
  const PlatoonModel model = model_with(paper_loop(2.4), 2.4);
  const double gain = string_stability(model).peak_gain;
  const std::vector<double> variances = stationary_variances(model, 5000);
  // P_i ~ c gain^{2i} / sqrt(i).
  const double ratio = variances[2000] / variances[1999] * std::sqrt(2001.0 / 2000.0);
  EXPECT_NEAR(ratio, gain * gain, 1e-5);
  EXPECT_TRUE(std::isinf(variances.back()));
  for (const double variance : variances) ASSERT_FALSE(std::isnan(variance));
}

TEST(StationaryVariance, IsNotANumberForAnUnstableVehicle) {
  const TransferFunction t = ramp_tracking(polynomial_with_zeros({1.01, 0.2}), 2.0);
  for (const double variance : stationary_variances(model_with(closed_loop_from(observable_canonical(t)), 2.0), 3)) {
    EXPECT_TRUE(std::isnan(variance));
  }
}

TEST(StationaryVariance, IsZeroWithoutNoise) {
  PlatoonModel model = model_with(paper_loop(2.4), 2.4);
  model.default_vehicle().position().noise_variance = 0.0;
  EXPECT_EQ(stationary_variances(model, 5000), std::vector<double>(5000, 0.0));
}

TEST(StationaryVariance, RejectsAnEmptyString) {
  EXPECT_THROW(stationary_variances(model_with(paper_loop(3.2), 3.2), 0), std::invalid_argument);
}

}  // namespace
}  // namespace platoon
