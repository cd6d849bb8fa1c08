#include "stochastic_platoon/math/paper/string_matrices.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "unit/math/example_loops.hpp"

namespace platoon {
namespace {

/// The state x_i of every vehicle, i = 0 .. N, at one step.
using Vehicles = std::vector<Eigen::VectorXd>;

Vehicles next(const StateSpace& loop, const Vehicles& now, double reference, const Eigen::VectorXd& noise) {
  Vehicles later;
  for (std::size_t i = 0; i < now.size(); ++i) {
    const double heard = i == 0 ? reference : loop.c() * now[i - 1] + noise(static_cast<Eigen::Index>(i) - 1);
    later.push_back(loop.a() * now[i] + loop.b() * heard);
  }
  return later;
}

/// xi_i(k) = x_{i-1}(k) - x_i(k) - h [x_i(k) - x_i(k-1)], paper eq. (statesxi).
Eigen::VectorXd errors_of_state(const Vehicles& now, const Vehicles& before, double h) {
  const Eigen::Index n = now.front().size();
  Eigen::VectorXd xi(n * static_cast<Eigen::Index>(now.size() - 1));
  for (std::size_t i = 1; i < now.size(); ++i) {
    xi.segment(n * static_cast<Eigen::Index>(i - 1), n) = now[i - 1] - now[i] - h * (now[i] - before[i]);
  }
  return xi;
}

TEST(StringMatrices, DriveTheErrorStatesAsTheVehicles) {
  for (const ExampleLoop& example : example_loops()) {
    const StateSpace& loop = example.loop.realization;
    const double h = example.headway;
    const StringMatrices string = string_matrices(loop, h, 3);
    Vehicles before(4, Eigen::VectorXd::Random(loop.order()));
    for (Eigen::VectorXd& state : before) state.setRandom();
    Eigen::VectorXd noise_before = Eigen::VectorXd::Random(3);
    double reference = 0.4;
    Vehicles now = next(loop, before, reference, noise_before);
    for (int k = 0; k < 5; ++k) {
      const Eigen::VectorXd noise = Eigen::VectorXd::Random(3);
      reference = 0.3 * k - 0.2;
      const Vehicles later = next(loop, now, reference, noise);
      const double y = loop.c() * now[0];
      const double y_before = loop.c() * before[0];
      const double leader_error = reference - y - h * (y - y_before);
      const Eigen::VectorXd expected = errors_of_state(later, now, h);
      const Eigen::VectorXd predicted = string.a * errors_of_state(now, before, h) + string.b_o * leader_error +
                                        string.b_a * noise + string.b_b * noise_before;
      EXPECT_LT((predicted - expected).cwiseAbs().maxCoeff(), 1e-9 * (1.0 + expected.cwiseAbs().maxCoeff()))
          << example.name;
      const Eigen::VectorXd outputs = string.c * expected;
      EXPECT_NEAR(outputs(2), loop.c() * expected.tail(loop.order()), 1e-12 * (1.0 + std::abs(outputs(2))));
      before = now;
      now = later;
      noise_before = noise;
    }
  }
}

TEST(StringMatrices, HaveTheShapesOfThePaper) {
  const StringMatrices string = string_matrices(paper_loop(3.2).realization, 3.2, 5);
  EXPECT_EQ(string.a.rows(), 15);
  EXPECT_EQ(string.a.cols(), 15);
  EXPECT_EQ(string.b_o.size(), 15);
  EXPECT_EQ(string.b_a.cols(), 5);
  EXPECT_EQ(string.b_b.cols(), 5);
  EXPECT_EQ(string.c.rows(), 5);
}

TEST(StringMatrices, RejectAnEmptyStringAndAHeadwayThatIsNotPositive) {
  const StateSpace loop = paper_loop(3.2).realization;
  EXPECT_THROW(string_matrices(loop, 3.2, 0), std::invalid_argument);
  EXPECT_THROW(string_matrices(loop, 0.0, 2), std::invalid_argument);
}

TEST(StringMatrices, HaveTheInitialStateOfVehiclesAfterOneStepFromRest) {
  const PlatoonModel model = model_with(paper_loop(3.2), 3.2);
  const StateSpace& loop = model.default_vehicle().loop.realization;
  const Eigen::Vector3d p(0.7, -1.1, 0.4);
  const Eigen::VectorXd equilibrium = unit_equilibrium(loop);
  const Eigen::VectorXd xi = initial_string(model, 3).response * p;
  Eigen::VectorXd ahead = Eigen::VectorXd::Zero(3);  // x_{i-1}(0)
  double heard = 0.0;                                // y_{i-1}(-1)
  for (Eigen::Index i = 0; i < 3; ++i) {
    const Eigen::VectorXd before = equilibrium * p(i);
    const Eigen::VectorXd now = loop.a() * before + loop.b() * heard;
    const Eigen::VectorXd expected = ahead - now - 3.2 * (now - before);
    EXPECT_LT((xi.segment(3 * i, 3) - expected).cwiseAbs().maxCoeff(), 1e-14);
    ahead = now;
    heard = loop.c() * before;
  }
}

TEST(StringMatrices, HaveAnInitialMeanOfTheFirstTwoFollowersOnly) {
  const InitialString initial = initial_string(model_with(paper_loop(3.2), 3.2), 5);
  EXPECT_GT(initial.mean.head(6).norm(), 0.1);
  EXPECT_LT(initial.mean.tail(9).norm(), 1e-14);
  EXPECT_NEAR((initial.covariance - 0.3 * initial.response * initial.response.transpose()).norm(), 0.0, 1e-14);
}

TEST(StringMatrices, SolveAScalarLyapunovEquationByTheGeometricSum) {
  const Eigen::MatrixXd a = Eigen::MatrixXd::Constant(1, 1, 0.999);
  const Eigen::MatrixXd q = Eigen::MatrixXd::Constant(1, 1, 2.0);
  EXPECT_NEAR(solve_discrete_lyapunov(a, q)(0, 0), 2.0 / (1.0 - 0.999 * 0.999), 1e-10);
}

TEST(StringMatrices, RejectEquationsWithoutASolutionAndAnEmptyString) {
  EXPECT_THROW(solve_discrete_lyapunov(Eigen::MatrixXd::Identity(2, 2), Eigen::MatrixXd::Identity(2, 2)),
               std::invalid_argument);
  EXPECT_THROW(solve_discrete_lyapunov(Eigen::MatrixXd::Zero(2, 2), Eigen::MatrixXd::Identity(3, 3)),
               std::invalid_argument);
  EXPECT_THROW(initial_string(model_with(paper_loop(3.2), 3.2), 0), std::invalid_argument);
}

}  // namespace
}  // namespace platoon
