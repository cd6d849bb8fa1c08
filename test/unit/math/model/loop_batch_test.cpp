#include "stochastic_platoon/math/model/loop_batch.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <stdexcept>
#include <vector>

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
  return {paper_loop(3.2).realization, observable_canonical(resolvent(large_loop()).transfer), first_order,
          dense_paper_loop(), large_loop()};
}

std::unique_ptr<LoopBatch> batch_of(const StateSpace& system) {
  return loop_batch(closed_loop_from(system));
}

std::vector<double> stepped(LoopBatch& loop, const std::vector<double>& input, double offset) {
  std::vector<double> positions(input.size());
  loop.step(input.data(), offset, positions.data(), {});
  return positions;
}

TEST(LoopBatch, IsTheConvolutionWithItsImpulseResponse) {
  constexpr std::size_t kSteps = 80;
  for (const StateSpace& system : loops()) {
    std::vector<double> impulse_response = {0.0};
    for (Eigen::VectorXd x = system.b(); impulse_response.size() <= kSteps; x = system.a() * x) {
      impulse_response.push_back(system.c() * x);
    }
    const std::vector<double> input = draw(1, {1, 0}, 0, kSteps);
    const std::unique_ptr<LoopBatch> loop = batch_of(system);
    loop->start({0.0}, 0.0);
    std::vector<double> output;
    for (std::size_t k = 0; k < kSteps; ++k) {
      double expected = 0.0;
      for (std::size_t j = 0; j < k; ++j) expected += impulse_response[k - j] * input[j];
      loop->output(output);
      ASSERT_EQ(output.size(), 1u);
      EXPECT_NEAR(output[0], expected, 1e-13);
      loop->step(&input[k], 0.0, output.data(), {});
    }
  }
}

TEST(LoopBatch, SubtractsTheOffsetFromItsInput) {
  const std::unique_ptr<LoopBatch> with_offset = batch_of(dense_paper_loop()), without = batch_of(dense_paper_loop());
  for (const auto& loop : {with_offset.get(), without.get()}) loop->start({1.0, -2.0}, 0.0);
  for (int k = 0; k < 20; ++k)
    EXPECT_EQ(stepped(*with_offset, {4.0 + k, 7.0}, 2.5), stepped(*without, {1.5 + k, 4.5}, 0.0));
}

TEST(LoopBatch, StaysAtRest) {
  const std::vector<double> places = {0.0, 1.0, -3.7, 250.0};
  for (const StateSpace& system : loops()) {
    const std::unique_ptr<LoopBatch> loop = batch_of(system);
    loop->start(places, 0.0);
    for (int k = 0; k < 500; ++k) {
      std::vector<double> output;
      loop->output(output);
      for (std::size_t r = 0; r < places.size(); ++r) ASSERT_NEAR(output[r], places[r], 1e-13 * std::abs(places[r]));
      loop->step(places.data(), 0.0, output.data(), {});
    }
  }
}

TEST(LoopBatch, ForgetsItsPastAtANewStart) {
  for (const StateSpace& system : loops()) {
    const std::unique_ptr<LoopBatch> used = batch_of(system), fresh = batch_of(system);
    used->start({1.0, 2.0, 3.0}, 0.0);
    for (int k = 0; k < 5; ++k) stepped(*used, {9.0, -9.0, 4.0}, 0.0);
    for (const auto& loop : {used.get(), fresh.get()}) loop->start({5.0, -1.0}, 0.0);
    for (int k = 0; k < 5; ++k) EXPECT_EQ(stepped(*used, {0.5, 0.25}, 0.0), stepped(*fresh, {0.5, 0.25}, 0.0));
  }
}

TEST(LoopBatch, HasTheSameBitsInEveryBatch) {
  constexpr std::size_t kRealizations = 2 * kTile + 37, kSteps = 30;
  const std::vector<double> places = draw(2, {1, 0}, 0, kRealizations);
  const std::vector<double> input = draw(3, {1, 0}, 0, kRealizations * kSteps);
  for (const StateSpace& system : loops()) {
    const auto run = [&](std::size_t first, std::size_t count) {
      const auto part = [&](const std::vector<double>& all, std::size_t row) {
        const auto begin = all.begin() + static_cast<std::ptrdiff_t>(row * kRealizations + first);
        return std::vector<double>(begin, begin + static_cast<std::ptrdiff_t>(count));
      };
      const std::unique_ptr<LoopBatch> loop = batch_of(system);
      loop->start(part(places, 0), 0.0);
      std::vector<std::vector<double>> outputs(kSteps);
      for (std::size_t k = 0; k < kSteps; ++k) outputs[k] = stepped(*loop, part(input, k), 0.3);
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

TEST(LoopBatch, RejectsALoopWithoutAStateOfRest) {
  Eigen::Matrix2d a;
  a << 1.0, 0.1, 0.0, 0.5;
  const StateSpace integrator(a, Eigen::Vector2d(0.0, 1.0), Eigen::RowVector2d(1.0, 0.0));
  EXPECT_THROW(batch_of(integrator), std::invalid_argument);
}

}  // namespace
}  // namespace platoon
