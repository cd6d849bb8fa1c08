#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <stdexcept>
#include <vector>

#include "stochastic_platoon/math/channel/link.hpp"
#include "stochastic_platoon/math/model/input.hpp"

namespace platoon {
namespace {

using Values = std::vector<double>;

constexpr std::uint64_t kSeed = 7;
constexpr std::uint32_t kReceiver = 3;

TEST(Quantiser, HasAWhiteErrorWithTheVarianceOfAUniformOne) {
  const double step = 0.5;
  Input input;
  input.link.quantisation_step = step;
  const std::unique_ptr<LinkStage> stage = quantiser(input, kSeed, kReceiver);
  const std::size_t count = 100000;
  Values before(count), error(count);
  for (const std::int64_t k : {0, 1}) {
    Values positions(count, 12.3);
    stage->step(k, 0, count, positions.data());
    double sum = 0.0, squares = 0.0, product = 0.0;
    for (std::size_t r = 0; r < count; ++r) {
      error[r] = positions[r] - 12.3;
      EXPECT_LE(std::abs(error[r]), 0.5 * step + 1e-12);
      sum += error[r];
      squares += error[r] * error[r];
      product += error[r] * before[r];
    }
    const double variance = step * step / 12.0, n = static_cast<double>(count);
    EXPECT_NEAR(sum / n, 0.0, 4.0 * std::sqrt(variance / n));
    EXPECT_NEAR(squares / n, variance, 4.0 * variance * std::sqrt(0.8 / n)) << "m4 - v^2 = 0.8 v^2";
    EXPECT_NEAR(product / n, 0.0, 4.0 * variance / std::sqrt(n));
    before = error;
  }
}

TEST(PacketLoss, HasZeroForALossWithoutAPredictor) {
  const std::unique_ptr<LinkStage> loss = packet_loss({0.5, {}, {}}, kSeed, kReceiver);
  Values start(2, 9.0);
  loss->start(0, 2, start.data(), 0.0);
  int lost = 0;
  for (std::int64_t k = 0; k < 200; ++k) {
    Values values(2, 7.0);
    loss->step(k, 0, 2, values.data());
    double chance;
    WhiteNoise(kSeed).fill_uniform({kReceiver, k, Purpose::loss}, 1, 1, &chance);
    const bool is_lost = chance < 0.5;
    EXPECT_EQ(values[1], is_lost ? 0.0 : 7.0) << k;
    lost += is_lost ? 1 : 0;
  }
  EXPECT_GT(lost, 60);
}

// The counter of a draw is its stream or'ed with 2^24 times its purpose, 0 .. 3.
TEST(LinkStages, OfAllInputsDrawFromStreamsOfTheirOwn) {
  std::set<std::uint32_t> counters;
  for (const std::uint32_t vehicle : {1u, 2u, (1u << 23) - 1u}) {
    for (std::uint32_t input = 0; input < 32; ++input) {
      const std::uint32_t stream = input_stream(vehicle, input);
      EXPECT_EQ(vehicle_of_stream(stream), vehicle);
      EXPECT_EQ(input_of_stream(stream), input);
      for (std::uint32_t purpose = 0; purpose < 4; ++purpose) counters.insert(stream | purpose << 24);
    }
  }
  EXPECT_EQ(counters.size(), 3u * 32u * 4u);
}

TEST(LinkStages, RejectInvalidOptions) {
  Input input;
  EXPECT_EQ(quantiser(input, 1, 1), nullptr);
  EXPECT_EQ(coloured_noise(input, 1, 1), nullptr);
  EXPECT_EQ(delay_line(input), nullptr);
  input.link.quantisation_step = -0.1;
  input.noise_variance = -1.0;
  input.link.delay = -1;
  EXPECT_THROW(quantiser(input, 1, 1), std::invalid_argument);
  EXPECT_THROW(coloured_noise(input, 1, 1), std::invalid_argument);
  EXPECT_THROW(delay_line(input), std::invalid_argument);
  input.noise_variance = 1.0;
  input.link.noise_filter = TransferFunction(Eigen::Vector2d(1.0, 1.0), Eigen::VectorXd::Ones(1));
  EXPECT_THROW(coloured_noise(input, 1, 1), std::invalid_argument) << "improper";
  EXPECT_THROW(packet_loss({1.0, {}, {1.0}}, 1, 1), std::invalid_argument);
}

// Holding: L F = z^-1 / (1 - q z^-1), of norm 1 / (1 - q^2).
TEST(LossModel, HasTheFeedbackOfItsLosses) {
  for (const double q : {0.01, 0.3, 0.9}) {
    const LossModel hold{q, {}, {1.0}};
    EXPECT_NEAR(loss_feedback(hold), q / (1.0 + q), 1e-14);
    EXPECT_NEAR(second_moment_radius(hold), q, 1e-14);
  }
  const LossModel extrapolate{0.3, {}, {2.0, -1.0}};
  double sum = 0.0, r1 = 1.0, r2 = 0.0;  // F's impulse response, and L F's a step later
  for (int k = 0; k < 200; ++k) {
    const double predicted = 2.0 * r1 - r2;
    sum += predicted * predicted;
    r2 = r1;
    r1 = 0.3 * predicted;
  }
  EXPECT_NEAR(loss_feedback(extrapolate), 0.7 * 0.3 * sum, 1e-13);
}

// At the border of the second moments: p q ||L F||^2 = 1 exactly if their radius is 1.
TEST(LossModel, HasTheSameBorderInBothForms) {
  for (const std::vector<double>& c : {std::vector<double>{3.0, -2.0}, {2.5, -1.0, -0.5}, {3.0, -3.0, 1.0}}) {
    double low = 0.0, high = 0.99;
    while (high - low > 1e-12) {
      const double q = 0.5 * (low + high);
      (loss_feedback({q, {}, c}) < 1.0 ? low : high) = q;
    }
    EXPECT_LT(second_moment_radius({low - 1e-9, {}, c}), 1.0);
    EXPECT_GT(second_moment_radius({high + 1e-9, {}, c}), 1.0);
  }
}

TEST(LossModel, IsIndependentForTheMeanBurstOfIndependentLosses) {
  EXPECT_TRUE((LossModel{0.2, 1.0 / 0.8, {1.0}}).is_independent());
  EXPECT_FALSE((LossModel{0.2, 2.0, {1.0}}).is_independent());
}

}  // namespace
}  // namespace platoon
