#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "stochastic_platoon/math/model/vehicle.hpp"
#include "unit/math/noise/draw.hpp"
#include "unit/paper_platoon.hpp"

namespace platoon {
namespace {

// Five states, and T(1) = 1.
StateSpace large_loop() {
  constexpr Eigen::Index kOrder = 5;
  Eigen::MatrixXd a(kOrder, kOrder);
  for (Eigen::Index i = 0; i < kOrder; ++i) {
    for (Eigen::Index j = 0; j < kOrder; ++j) a(i, j) = 0.1 + 0.03 * static_cast<double>(i - 2 * j);
  }
  const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(kOrder, 0.5, 1.5);
  const Eigen::RowVectorXd c = Eigen::RowVectorXd::LinSpaced(kOrder, 2.0, 1.0);
  const double gain = c * (Eigen::MatrixXd::Identity(kOrder, kOrder) - a).partialPivLu().solve(b);
  return {a, b, c / gain};
}

// Shift registers of three, five and one states, and loops in other forms.
std::vector<StateSpace> loops() {
  const StateSpace first_order(Eigen::MatrixXd::Constant(1, 1, 0.4), Eigen::VectorXd::Constant(1, 0.6),
                               Eigen::RowVectorXd::Ones(1));
  return {paper_loop(3.2).realization, observable_canonical(transfer_function(large_loop())), first_order,
          dense_paper_loop(), large_loop()};
}

TEST(ClosedLoopBatch, IsTheConvolutionWithItsImpulseResponse) {
  constexpr std::size_t kSteps = 80;
  for (const StateSpace& system : loops()) {
    std::vector<double> impulse_response = {0.0};
    for (Eigen::VectorXd x = system.b(); impulse_response.size() <= kSteps; x = system.a() * x) {
      impulse_response.push_back(system.c() * x);
    }
    const std::vector<double> input = draw(1, {1, 0}, 0, kSteps);
    ClosedLoopBatch loop(system);
    loop.start_at_equilibrium({0.0});
    std::vector<double> output;
    for (std::size_t k = 0; k < kSteps; ++k) {
      double expected = 0.0;
      for (std::size_t j = 0; j < k; ++j) expected += impulse_response[k - j] * input[j];
      loop.output(output);
      ASSERT_EQ(output.size(), 1u);
      EXPECT_NEAR(output[0], expected, 1e-13);
      loop.step({input[k]}, 0.0, output);
    }
  }
}

TEST(ClosedLoopBatch, SubtractsTheOffsetFromItsInput) {
  ClosedLoopBatch with_offset(dense_paper_loop()), without(dense_paper_loop());
  std::vector<double> one, other;
  with_offset.start_at_equilibrium({1.0, -2.0});
  without.start_at_equilibrium({1.0, -2.0});
  for (int k = 0; k < 20; ++k) {
    with_offset.step({4.0 + k, 7.0}, 2.5, one);
    without.step({1.5 + k, 4.5}, 0.0, other);
    EXPECT_EQ(one, other);
  }
}

TEST(ClosedLoopBatch, StaysAtRest) {
  const std::vector<double> places = {0.0, 1.0, -3.7, 250.0};
  for (const StateSpace& system : loops()) {
    ClosedLoopBatch loop(system);
    loop.start_at_equilibrium(places);
    for (int k = 0; k < 500; ++k) {
      std::vector<double> output;
      loop.output(output);
      for (std::size_t r = 0; r < places.size(); ++r) ASSERT_NEAR(output[r], places[r], 1e-13 * std::abs(places[r]));
      loop.step(places, 0.0, output);
    }
  }
}

TEST(ClosedLoopBatch, ForgetsItsPastAtANewStart) {
  for (const StateSpace& system : loops()) {
    ClosedLoopBatch loop(system), fresh(system);
    loop.start_at_equilibrium({1.0, 2.0, 3.0});
    std::vector<double> output, expected;
    for (int k = 0; k < 5; ++k) loop.step({9.0, -9.0, 4.0}, 0.0, output);
    for (ClosedLoopBatch* batch : {&loop, &fresh}) batch->start_at_equilibrium({5.0, -1.0});
    for (int k = 0; k < 5; ++k) {
      loop.step({0.5, 0.25}, 0.0, output);
      fresh.step({0.5, 0.25}, 0.0, expected);
      EXPECT_EQ(output, expected);
    }
  }
}

TEST(ClosedLoopBatch, HasTheSameBitsInEveryBatch) {
  constexpr std::size_t kRealizations = 2 * kTile + 37, kSteps = 30;
  const std::vector<double> places = draw(2, {1, 0}, 0, kRealizations);
  const std::vector<double> input = draw(3, {1, 0}, 0, kRealizations * kSteps);
  for (const StateSpace& system : loops()) {
    const auto run = [&](std::size_t first, std::size_t count) {
      const auto part = [&](const std::vector<double>& all, std::size_t row) {
        const auto begin = all.begin() + static_cast<std::ptrdiff_t>(row * kRealizations + first);
        return std::vector<double>(begin, begin + static_cast<std::ptrdiff_t>(count));
      };
      ClosedLoopBatch loop(system);
      loop.start_at_equilibrium(part(places, 0));
      std::vector<std::vector<double>> outputs(kSteps);
      for (std::size_t k = 0; k < kSteps; ++k) loop.step(part(input, k), 0.3, outputs[k]);
      return outputs;
    };
    const auto whole = run(0, kRealizations);
    for (const std::size_t batch : {std::size_t{1}, std::size_t{7}, kTile, kTile + 1}) {
      for (std::size_t first = 0; first < kRealizations; first += batch) {
        const std::size_t count = std::min(batch, kRealizations - first);
        const auto some = run(first, count);
        for (std::size_t k = 0; k < kSteps; ++k) {
          for (std::size_t r = 0; r < count; ++r) ASSERT_EQ(some[k][r], whole[k][first + r]);
        }
      }
    }
  }
}

TEST(ClosedLoopBatch, RejectsALoopWithoutAStateOfRest) {
  Eigen::Matrix2d a;
  a << 1.0, 0.1, 0.0, 0.5;
  const StateSpace integrator(a, Eigen::Vector2d(0.0, 1.0), Eigen::RowVector2d(1.0, 0.0));
  EXPECT_THROW(ClosedLoopBatch batch(integrator), std::invalid_argument);
}

}  // namespace
}  // namespace platoon
