#include <gtest/gtest.h>

#include <cmath>

#include "stochastic_platoon/math/model/vehicle.hpp"
#include "unit/math/noise/draw.hpp"

namespace platoon {
namespace {

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
  const std::vector<double> sent = draw(4, {1, 0}, 0, 40);
  for (const std::int64_t step : {0, 1, 77}) {
    std::vector<double> received;
    AwgnChannel(0.6, 9, 5).transmit(step, 33, sent, received);
    const std::vector<double> g = draw(9, {5, step}, 33, 40);
    ASSERT_EQ(received.size(), 40u);
    for (std::size_t r = 0; r < 40; ++r) EXPECT_EQ(received[r], sent[r] + std::sqrt(0.6) * g[r]);
  }
}

TEST(AwgnChannel, HasNoState) {
  const AwgnChannel channel(0.6, 9, 5);
  const std::vector<double> sent = draw(4, {1, 0}, 0, 40);
  std::vector<double> first, between, again;
  channel.transmit(3, 8, sent, first);
  channel.transmit(7, 100, sent, between);
  channel.transmit(3, 8, sent, again);
  EXPECT_EQ(first, again);
  EXPECT_NE(first, between);
}

TEST(AwgnChannel, AddsTheSameBitsInEveryBatch) {
  const AwgnChannel channel(0.6, 9, 5);
  const std::vector<double> sent = draw(4, {1, 0}, 0, kTile + 40);
  std::vector<double> whole, single;
  channel.transmit(3, 11, sent, whole);
  for (std::size_t r = 0; r < sent.size(); ++r) {
    channel.transmit(3, 11 + r, {sent[r]}, single);
    EXPECT_EQ(single, std::vector<double>{whole[r]});
  }
}

}  // namespace
}  // namespace platoon
