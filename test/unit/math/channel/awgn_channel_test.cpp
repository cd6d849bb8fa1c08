#include "stochastic_platoon/math/channel/awgn_channel.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "stochastic_platoon/math/numerics/aligned_values.hpp"
#include "unit/math/noise/draw.hpp"
#include "unit/transmitted.hpp"

namespace platoon {
namespace {

TEST(AwgnChannel, AddsNothingAtTheInitialStep) {
  const std::vector<double> sent = {1.5, -2.0, 0.0};
  EXPECT_EQ(transmitted(AwgnChannel(0.6, 1, 1), -1, 0, sent), sent);
}

TEST(AwgnChannel, AddsNothingWithoutVariance) {
  const std::vector<double> sent = {1.5, -2.0, 0.0};
  EXPECT_EQ(transmitted(AwgnChannel(0.0, 1, 1), 4, 0, sent), sent);
}

TEST(AwgnChannel, AddsTheNoiseOfItsReceiverStepAndRealization) {
  const std::vector<double> sent = draw(4, {1, 0}, 0, 40);
  for (const std::int64_t step : {0, 1, 77}) {
    const std::vector<double> received = transmitted(AwgnChannel(0.6, 9, 5), step, 33, sent);
    const std::vector<double> g = draw(9, {5, step}, 33, 40);
    for (std::size_t r = 0; r < 40; ++r) EXPECT_EQ(received[r], sent[r] + std::sqrt(0.6) * g[r]);
  }
}

TEST(AwgnChannel, HasNoState) {
  const AwgnChannel channel(0.6, 9, 5);
  const std::vector<double> sent = draw(4, {1, 0}, 0, 40);
  const std::vector<double> first = transmitted(channel, 3, 8, sent);
  EXPECT_NE(transmitted(channel, 7, 100, sent), first);
  EXPECT_EQ(transmitted(channel, 3, 8, sent), first);
}

TEST(AwgnChannel, AddsTheSameBitsInEveryBatch) {
  const AwgnChannel channel(0.6, 9, 5);
  const std::vector<double> sent = draw(4, {1, 0}, 0, kTile + 40);
  const std::vector<double> whole = transmitted(channel, 3, 11, sent);
  for (std::size_t r = 0; r < sent.size(); ++r) EXPECT_EQ(transmitted(channel, 3, 11 + r, {sent[r]}).front(), whole[r]);
}

}  // namespace
}  // namespace platoon
