#include "stochastic_platoon/math/channel/awgn_channel.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "stochastic_platoon/math/numerics/aligned_values.hpp"
#include "unit/transmitted.hpp"

namespace platoon {
namespace {

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

TEST(AwgnChannel, AddsNothingAtTheInitialStep) {
  const std::vector<double> sent = {1.5, -2.0, 0.0};
  EXPECT_EQ(transmitted(AwgnChannel(0.6, 1, 1), -1, 0, sent), sent);
}

TEST(AwgnChannel, AddsNothingWithoutVariance) {
  const std::vector<double> sent = {1.5, -2.0, 0.0};
  EXPECT_EQ(transmitted(AwgnChannel(0.0, 1, 1), 4, 0, sent), sent);
}

TEST(AwgnChannel, AddsTheNoiseOfItsReceiverStepAndRealization) {
  const std::vector<double> sent = random_values(40, 4);
  for (const std::int64_t step : {0, 1, 77}) {
    const std::vector<double> received = transmitted(AwgnChannel(0.6, 9, 5), step, 33, sent);
    const std::vector<double> g = normals(9, {5, step}, 33, 40);
    for (std::size_t r = 0; r < 40; ++r) EXPECT_EQ(received[r], sent[r] + std::sqrt(0.6) * g[r]);
  }
}

TEST(AwgnChannel, KeepsNothingBetweenCalls) {
  const AwgnChannel channel(0.6, 9, 5);
  const std::vector<double> sent = random_values(40, 4);
  const std::vector<double> first = transmitted(channel, 3, 8, sent);
  EXPECT_NE(transmitted(channel, 7, 100, sent), first);
  EXPECT_EQ(transmitted(channel, 3, 8, sent), first);
}

TEST(AwgnChannel, AddsTheSameBitsInEveryBatch) {
  const AwgnChannel channel(0.6, 9, 5);
  const std::vector<double> sent = random_values(kTile + 40, 4);
  const std::vector<double> whole = transmitted(channel, 3, 11, sent);
  for (std::size_t r = 0; r < sent.size(); ++r) EXPECT_EQ(transmitted(channel, 3, 11 + r, {sent[r]}).front(), whole[r]);
}

}  // namespace
}  // namespace platoon
