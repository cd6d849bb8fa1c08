#include "stochastic_platoon/math/channel/link.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "unit/math/noise/draw.hpp"
#include "unit/paper_platoon.hpp"
#include "unit/transmitted.hpp"

namespace platoon {
namespace {

using Values = std::vector<double>;

constexpr std::uint64_t kSeed = 7;
constexpr std::uint32_t kReceiver = 3;
constexpr std::int64_t kSteps = 40;

// y(k) of realization r: a different value for every k and r.
double sent(std::int64_t step, std::uint64_t realization) {
  return 2.0 * static_cast<double>(step) + std::sin(static_cast<double>(3 * step) + static_cast<double>(realization));
}

// received[k + 1][r] of realizations 0 .. count - 1, in batches.
std::vector<Values> through(Link& link, std::size_t count, std::size_t batch) {
  std::vector<Values> received(kSteps + 1, Values(count));
  for (std::size_t first = 0; first < count; first += batch) {
    const std::size_t size = std::min(batch, count - first);
    for (std::int64_t k = -1; k < kSteps; ++k) {
      Values in(size);
      for (std::size_t r = 0; r < size; ++r) in[r] = sent(k, first + r);
      const Values out = transmitted(link, k, first, in);
      std::copy(out.begin(), out.end(),
                received[static_cast<std::size_t>(k + 1)].begin() + static_cast<std::ptrdiff_t>(first));
    }
  }
  return received;
}

PlatoonModel platoon_with(const LinkModel& link, double noise_variance) {
  PlatoonModel model = paper_platoon();
  model.default_vehicle().position().link = link;
  model.default_vehicle().position().noise_variance = noise_variance;
  return model;
}

double uniform(Purpose purpose, std::int64_t step, std::uint64_t realization) {
  double value;
  WhiteNoise(kSeed).fill_uniform({kReceiver, step, purpose}, realization, 1, &value);
  return value;
}

// The received values of one realization over a link with all stages, by definition.
Values by_definition(const LinkModel& link, double noise_variance, std::uint64_t realization) {
  const Polynomial &b = link.noise_filter.numerator(), &a = link.noise_filter.denominator();
  Values in{sent(-1, realization)}, used, noise, g;  // from step -1 on; noise from step 0 on
  used = in;
  Values received{sent(-1, realization)};
  bool lost_before = false;
  const auto before = [](const Values& values, std::ptrdiff_t place) {
    return place < 0 ? values.front() : values[static_cast<std::size_t>(place)];
  };
  for (std::int64_t k = 0; k < kSteps; ++k) {
    double s = sent(k, realization);
    if (link.quantisation_step > 0.0) {
      const double step = link.quantisation_step, nu = step * (uniform(Purpose::dither, k, realization) - 0.5);
      s = step * std::floor((s + nu) / step + 0.5) - nu;
    }
    g.push_back(draw(kSeed, {kReceiver, k}, realization, 1).front());
    double d = 0.0;
    const Eigen::Index lead = a.size() - b.size();
    for (Eigen::Index j = 0; j < a.size() && j <= k; ++j) {
      if (j >= lead) d += b(j - lead) * g[static_cast<std::size_t>(k - j)];
      if (j > 0) d -= a(j) * noise[static_cast<std::size_t>(k - j)];
    }
    noise.push_back(d);
    in.push_back(s + std::sqrt(noise_variance) * d);
    const double arriving = before(in, k + 1 - link.delay);
    double predicted = 0.0;
    for (std::size_t j = 0; j < link.loss->predictor.size(); ++j)
      predicted += link.loss->predictor[j] * before(used, k - static_cast<std::ptrdiff_t>(j));
    const double q = link.loss->probability;
    const double chance = !link.loss->mean_burst || k == 0 ? q
                          : lost_before                    ? 1.0 - 1.0 / *link.loss->mean_burst
                                                           : q / (*link.loss->mean_burst * (1.0 - q));
    lost_before = uniform(Purpose::loss, k, realization) < chance;
    used.push_back(lost_before ? predicted : arriving);
    received.push_back(used.back());
  }
  return received;
}

LinkModel everything(bool bursts) {
  LinkModel link;
  link.noise_filter = {Eigen::Vector2d(0.8, 0.3), Eigen::Vector3d(1.0, -0.5, 0.1)};
  link.quantisation_step = 0.25;
  link.delay = 3;
  link.loss = LossModel{0.3, bursts ? std::optional<double>(2.5) : std::nullopt, {1.5, -0.8, 0.3}};
  return link;
}

TEST(Link, FollowsTheDefinitionOfItsStages) {
  for (const bool bursts : {false, true}) {
    const LinkModel model = everything(bursts);
    Link link(platoon_with(model, 0.6), kSeed, kReceiver);
    EXPECT_TRUE(link.keeps_state());
    const std::vector<Values> received = through(link, 1030, 1030);
    for (const std::size_t r : {0, 1, 511, 512, 1029}) {
      const Values expected = by_definition(model, 0.6, r);
      for (std::size_t k = 0; k < expected.size(); ++k) EXPECT_NEAR(received[k][r], expected[k], 1e-9) << k;
    }
  }
}

TEST(Link, HasTheSameBitsForEveryBatch) {
  Link link(platoon_with(everything(true), 0.6), kSeed, kReceiver);
  const std::vector<Values> whole = through(link, 600, 600);
  for (const std::size_t batch : {1, 7, 512}) EXPECT_EQ(through(link, 600, batch), whole) << batch;
}

TEST(Link, OfThePaperEqualsTheAwgnChannelToTheBit) {
  LinkModel never;
  never.loss = LossModel{};
  for (const LinkModel& model : {LinkModel(), never}) {
    Link link(platoon_with(model, 0.6), kSeed, kReceiver);
    EXPECT_FALSE(link.keeps_state());
    const AwgnChannel channel(0.6, kSeed, kReceiver);
    for (const std::int64_t k : {-1, 5, 0}) {
      const Values in(700, 2.5);
      EXPECT_EQ(transmitted(link, k, 100, in), transmitted(channel, k, 100, in));
    }
  }
}

// Stages that draw by name alone accept a batch from any step on.
TEST(Link, KeepsStateIfOneOfItsStagesDoes) {
  const auto keeps_state = [](LinkModel link, double noise_variance) {
    return Link(platoon_with(link, noise_variance), kSeed, kReceiver).keeps_state();
  };
  LinkModel quantised, delayed, coloured, lossy, scaled;
  quantised.quantisation_step = 0.1;
  delayed.delay = 1;
  coloured.noise_filter = {Eigen::VectorXd::Ones(1), Eigen::Vector2d(1.0, -0.5)};
  scaled.noise_filter = {2.0 * Eigen::VectorXd::Ones(1), Eigen::VectorXd::Ones(1)};
  lossy.loss = LossModel{0.1, {}, {1.0}};
  EXPECT_FALSE(keeps_state(quantised, 0.6));
  EXPECT_FALSE(keeps_state(scaled, 0.6));
  EXPECT_FALSE(keeps_state(coloured, 0.0));
  EXPECT_TRUE(keeps_state(coloured, 0.6));
  EXPECT_TRUE(keeps_state(delayed, 0.6));
  EXPECT_TRUE(keeps_state(lossy, 0.6));
}

// The lost fraction has the standard error of a mean over the chain, sqrt(q (1 - q) (1 + rho) / (1 - rho) / n) with rho
// = 1 - 1/b - q/(b (1 - q)); 1 - 1/b is the probability of a loss after a loss.
TEST(Link, LosesWithTheGivenProbabilityAndMeanBurst) {
  LinkModel model;
  model.loss = LossModel{0.2, 4.0, {1.0}};
  Link link(platoon_with(model, 0.0), kSeed, kReceiver);
  const std::size_t count = 20000;
  const std::vector<Values> received = through(link, count, count);
  double losses = 0.0, bursts = 0.0, first = 0.0;
  for (std::size_t r = 0; r < count; ++r) {
    bool before = false;
    for (std::size_t k = 1; k <= kSteps; ++k) {
      const bool lost = received[k][r] == received[k - 1][r];
      losses += lost ? 1.0 : 0.0;
      bursts += lost && !before ? 1.0 : 0.0;
      first += lost && k == 1 ? 1.0 : 0.0;
      before = lost;
    }
  }
  const double n = static_cast<double>(count) * kSteps, q = 0.2, rho = 0.75 - q / (4.0 * 0.8);
  EXPECT_NEAR(losses / n, q, 4.0 * std::sqrt(q * (1.0 - q) * (1.0 + rho) / (1.0 - rho) / n));
  EXPECT_NEAR(first / count, q, 4.0 * std::sqrt(q * (1.0 - q) / count)) << "stationary from k = 0 on";
  // A burst begins with probability q / b a step, and at step 0 with q; its count varies by less than a Poisson's.
  const double expected = static_cast<double>(count) * (q + (kSteps - 1) * q / 4.0);
  EXPECT_NEAR(bursts, expected, 4.0 * std::sqrt(expected));
}

// v(k) = u(k-1) is sent with the position of step k: with a delay of m the link itself delays by m - 1 steps.
TEST(Radio, HasItsOwnDelayAndNoise) {
  constexpr double kVariance = 0.04;
  PlatoonModel model = paper_platoon();
  model.default_vehicle().inputs.push_back({InputSignal::input, kVariance});
  model.default_vehicle().radio()->link.delay = 3;
  Link radio(model, kSeed, kReceiver, 1);
  const std::vector<Values> received = through(radio, 2, 2);
  EXPECT_EQ(received[0][1], sent(-1, 1));
  for (std::int64_t k = 2; k < kSteps; ++k) {
    const double noise =
        draw(kSeed, {kReceiver + (1u << 23), k - 2}, 1, 1).front();  // the draw of the step at which it was sent
    EXPECT_DOUBLE_EQ(received[static_cast<std::size_t>(k + 1)][1], sent(k - 2, 1) + 0.2 * noise) << k;
  }
  model.default_vehicle().radio()->link.delay = 0;
  EXPECT_THROW(Link(model, kSeed, kReceiver, 1), std::invalid_argument);
  EXPECT_THROW(Link(model, kSeed, kReceiver, 2), std::out_of_range);
}

}  // namespace
}  // namespace platoon
