#include "stochastic_platoon/math/model/vehicle.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

#include "unit/fractions.hpp"
#include "unit/paper_platoon.hpp"

namespace platoon {
namespace {

// The paper's loop in other coordinates: no entry of A, B, C is zero or one.
StateSpace dense_loop() {
  Eigen::Matrix3d basis;
  basis << 1.0, 0.3, -0.2, 0.5, -1.0, 0.4, 0.1, 0.2, 0.9;
  const StateSpace paper = paper_platoon().default_vehicle().loop.realization;
  return {basis * paper.a() * basis.inverse(), basis * paper.b(), paper.c() * basis.inverse()};
}

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
  return {paper_platoon(3.2).default_vehicle().loop.realization, observable_canonical(transfer_of(large_loop())),
          first_order, dense_loop(), large_loop()};
}

std::vector<double> random_values(std::size_t count, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> value(0.0, 3.0);
  std::vector<double> values(count);
  for (double& v : values) v = value(generator);
  return values;
}

std::vector<double> normals(std::uint64_t seed, DrawName name, std::uint64_t first, std::size_t count) {
  std::vector<double> g(count);
  WhiteNoise(seed).fill(name, first, count, g.data());
  return g;
}

TEST(ClosedLoopBatch, AnswersWithTheConvolutionOfItsImpulseResponse) {
  constexpr std::size_t kSteps = 80;
  for (const StateSpace& system : loops()) {
    std::vector<double> impulse_response = {0.0};
    for (Eigen::VectorXd x = system.b(); impulse_response.size() <= kSteps; x = system.a() * x) {
      impulse_response.push_back(system.c() * x);
    }
    const std::vector<double> input = random_values(kSteps, 1);
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

TEST(ClosedLoopBatch, TakesTheOffsetFromItsInput) {
  ClosedLoopBatch with_offset(dense_loop()), without(dense_loop());
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

TEST(ClosedLoopBatch, RestsWhereItIsPutWhateverItDidBefore) {
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

TEST(ClosedLoopBatch, GivesTheSameBitsInEveryBatch) {
  constexpr std::size_t kRealizations = 2 * kTile + 37, kSteps = 30;
  const std::vector<double> places = random_values(kRealizations, 2);
  const std::vector<double> input = random_values(kRealizations * kSteps, 3);
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

TEST(ClosedLoopBatch, WithoutAStateOfRestIsRefused) {
  Eigen::Matrix2d a;
  a << 1.0, 0.1, 0.0, 0.5;
  const StateSpace integrator(a, Eigen::Vector2d(0.0, 1.0), Eigen::RowVector2d(1.0, 0.0));
  EXPECT_THROW(ClosedLoopBatch batch(integrator), std::invalid_argument);
}

TEST(FollowerVehicle, StartsInItsPlaceWhenNothingIsRandom) {
  PlatoonModel model = paper_platoon();
  model.default_vehicle().standstill_distance = 6.5;
  model.default_vehicle().initial_position = {0.25, 0.0};
  std::vector<double> positions;
  FollowerVehicle(model, 1, 4).start(10, 3, positions);
  ASSERT_EQ(positions.size(), 3u);
  for (const double position : positions) EXPECT_NEAR(position, -4.0 * 6.5 + 0.25, 1e-13);
}

TEST(FollowerVehicle, StartsWithTheNoiseOfStepMinusOne) {
  PlatoonModel model = paper_platoon();
  model.default_vehicle().standstill_distance = 6.5;
  model.default_vehicle().initial_position = {0.25, 2.0};
  std::vector<double> positions;
  FollowerVehicle(model, 5, 3).start(101, 50, positions);
  const std::vector<double> g = normals(5, {3, -1}, 101, 50);
  for (std::size_t r = 0; r < 50; ++r) {
    EXPECT_NEAR(positions[r], -3.0 * 6.5 + 0.25 + std::sqrt(2.0) * g[r], 1e-13);
  }
}

// The tolerance is four standard errors of mean and variance of n normals, sqrt(v / n) and v sqrt(2 / n).
TEST(FollowerVehicle, StartsWithTheMeanAndTheVarianceOfTheModel) {
  PlatoonModel model = paper_platoon();
  model.default_vehicle().standstill_distance = 6.5;
  model.default_vehicle().initial_position = {-0.8, 0.3};
  constexpr std::size_t kCount = 40000;
  std::vector<double> positions;
  FollowerVehicle(model, 1, 2).start(0, kCount, positions);
  double mean = 0.0, variance = 0.0;
  for (const double position : positions) mean += position / kCount;
  for (const double position : positions) variance += (position - mean) * (position - mean) / kCount;
  EXPECT_NEAR(mean, -13.0 - 0.8, 4.0 * std::sqrt(0.3 / kCount));
  EXPECT_NEAR(variance, 0.3, 4.0 * 0.3 * std::sqrt(2.0 / kCount));
}

TEST(FollowerVehicle, StandsStillBehindAPredecessorThatStandsInItsPlace) {
  PlatoonModel model = paper_platoon();
  model.default_vehicle().standstill_distance = 6.5;
  FollowerVehicle follower(model, 1, 3);
  std::vector<double> positions;
  follower.start(0, 2, positions);
  for (int k = 0; k < 200; ++k) {
    follower.step({-2.0 * 6.5, -2.0 * 6.5}, positions);
    for (const double position : positions) ASSERT_NEAR(position, -3.0 * 6.5, 1e-12);
  }
}

TEST(FollowerVehicle, BeginsAnewWithEveryStart) {
  PlatoonModel model = paper_platoon();
  model.default_vehicle().initial_position = {0.0, 1.0};
  FollowerVehicle used(model, 1, 1), fresh(model, 1, 1);
  std::vector<double> one, other;
  used.start(0, 5, one);
  for (int k = 0; k < 7; ++k) used.step({1.0, 2.0, 3.0, 4.0, 5.0}, one);
  used.start(20, 3, one);
  fresh.start(20, 3, other);
  EXPECT_EQ(one, other);
  used.step({0.1, 0.2, 0.3}, one);
  fresh.step({0.1, 0.2, 0.3}, other);
  EXPECT_EQ(one, other);
}

TEST(LeaderVehicle, HearsTheVirtualLeaderOneStepLater) {
  PlatoonModel model = paper_platoon();
  LeaderVehicle leader(model);
  EXPECT_EQ(leader.start(), 0.0);
  EXPECT_EQ(leader.step(), 0.0);                        // y_0(0): r_0(-1) = 0
  EXPECT_EQ(leader.step(), 0.0);                        // y_0(1): r_0(0) = 0
  EXPECT_EQ(leader.step(), 0.0);                        // y_0(2): T has the relative degree 2
  EXPECT_NEAR(leader.step(), 1.35 / 4.2 * 2.0, 1e-14);  // y_0(3): r_0(1) = 2
}

// T(1) = 1 and dT/dz(1) = -h: on a ramp the leader follows the virtual one at the distance of the headway.
TEST(LeaderVehicle, TracksARampAtItsHeadway) {
  for (const double h : {3.2, 2.4}) {
    LeaderVehicle leader(paper_platoon(h));
    leader.start();
    double position = 0.0;
    for (std::int64_t k = 0; k <= 200; ++k) position = leader.step();
    EXPECT_NEAR(position, 2.0 * 200 - h * 2.0, 1e-10);
  }
}

TEST(LeaderVehicle, BeginsAnewWithEveryStart) {
  LeaderVehicle leader(paper_platoon());
  std::vector<double> first, second;
  for (std::vector<double>* run : {&first, &second}) {
    run->push_back(leader.start());
    for (int k = 0; k < 40; ++k) run->push_back(leader.step());
  }
  EXPECT_EQ(first, second);
}

TEST(AwgnChannel, AddsNothingAtTheInitialStep) {
  const std::vector<double> sent = {1.5, -2.0, 0.0};
  std::vector<double> received;
  AwgnChannel(0.6, 1, 1).transmit(-1, 0, sent, received);
  EXPECT_EQ(received, sent);
}

TEST(AwgnChannel, AddsNothingWithoutVariance) {
  const std::vector<double> sent = {1.5, -2.0, 0.0};
  std::vector<double> received(7, 3.0);
  AwgnChannel(0.0, 1, 1).transmit(4, 0, sent, received);
  EXPECT_EQ(received, sent);
}

TEST(AwgnChannel, AddsTheNoiseOfItsReceiverStepAndRealization) {
  const std::vector<double> sent = random_values(40, 4);
  for (const std::int64_t step : {0, 1, 77}) {
    std::vector<double> received;
    AwgnChannel(0.6, 9, 5).transmit(step, 33, sent, received);
    const std::vector<double> g = normals(9, {5, step}, 33, 40);
    ASSERT_EQ(received.size(), 40u);
    for (std::size_t r = 0; r < 40; ++r) EXPECT_EQ(received[r], sent[r] + std::sqrt(0.6) * g[r]);
  }
}

TEST(AwgnChannel, KeepsNothingBetweenCalls) {
  const AwgnChannel channel(0.6, 9, 5);
  const std::vector<double> sent = random_values(40, 4);
  std::vector<double> first, between, again;
  channel.transmit(3, 8, sent, first);
  channel.transmit(7, 100, sent, between);
  channel.transmit(3, 8, sent, again);
  EXPECT_EQ(first, again);
  EXPECT_NE(first, between);
}

TEST(AwgnChannel, AddsTheSameBitsInEveryBatch) {
  const AwgnChannel channel(0.6, 9, 5);
  const std::vector<double> sent = random_values(kTile + 40, 4);
  std::vector<double> whole, single;
  channel.transmit(3, 11, sent, whole);
  for (std::size_t r = 0; r < sent.size(); ++r) {
    channel.transmit(3, 11 + r, {sent[r]}, single);
    EXPECT_EQ(single, std::vector<double>{whole[r]});
  }
}

}  // namespace
}  // namespace platoon
