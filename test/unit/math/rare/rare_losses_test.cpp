#include "stochastic_platoon/math/rare/rare_losses.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "stochastic_platoon/math/channel/link.hpp"
#include "stochastic_platoon/math/rare/path_draws.hpp"
#include "unit/math/lossy_platoon.hpp"

namespace platoon {
namespace {

using Modes = std::vector<std::uint8_t>;

constexpr std::int64_t kSteps = 3;
constexpr std::size_t kPaths = 200000;

// Follower 1 has bursts, 2 a chain of which two modes are rare and one, (good, lost), is not.
PlatoonModel two_links() {
  PlatoonModel model = lossy_platoon({0.02, 3.0, {1.0}});
  VehicleModel second = model.default_vehicle();
  second.position().link.loss =
      by_states((Eigen::Matrix2d() << 0.98, 0.02, 0.4, 0.6).finished(), Eigen::Vector2d(0.2, 0.7), {1.0});
  model.types.push_back({"second", second, {}});
  model.string = {0, 1};
  return model;
}

LossChain chain(const PlatoonModel& model, std::size_t follower) {
  return LossChain(*vehicle(model, follower).inputs.front().link.loss);
}

// The modes of both links in each of the realizations 0, 1, ....
std::vector<Modes> modes(const PlatoonModel& model, const WhiteNoise& noise) {
  std::vector<Modes> result(kPaths);
  std::vector<double> uniforms(kPaths);
  for (std::uint32_t follower = 1; follower <= 2; ++follower) {
    const ModeChances chances(chain(model, follower));
    for (std::int64_t step = 0; step < kSteps; ++step) {
      noise.fill_uniform({loss_stream(model, follower, 0), step, Purpose::loss}, 0, kPaths, uniforms.data());
      for (std::size_t s = 0; s < kPaths; ++s)
        result[s].push_back(step == 0 ? chances.first(uniforms[s]) : chances.after(result[s].back(), uniforms[s]));
    }
  }
  return result;
}

TEST(RareLosses, WeighThePathsOfTwoLinksByTheirProbabilities) {
  const PlatoonModel model = two_links();
  const RareLosses losses(model, 2, kSteps);
  ASSERT_FALSE(losses.empty());

  std::vector<std::shared_ptr<const GivenModes>> given;
  for (std::size_t s = 0; s < kPaths; ++s) {
    std::uint32_t number = 0;
    given.push_back(losses.draw([&] {
      double value = 0.0;
      WhiteNoise(5).fill_uniform({1, number++, Purpose::choice}, s, 1, &value);
      return value;
    }));
  }
  const WhiteNoise noise(7, std::make_shared<PathDraws>(0, given));
  std::vector<double> weights(kPaths);
  std::vector<std::int64_t> begins(kPaths);
  losses.weights(noise, 0, kPaths, weights.data(), begins.data());
  std::map<Modes, double> sums, squares;
  const std::vector<Modes> found = modes(model, noise);
  for (std::size_t s = 0; s < kPaths; ++s) {
    ASSERT_TRUE(std::isfinite(weights[s]));
    sums[found[s]] += weights[s];
    squares[found[s]] += weights[s] * weights[s];
  }

  // The rare modes: lost of the bursts; of the chain, with (good, arrived), (bad, arrived), (good, lost), (bad, lost),
  // those of the bad state.
  const LossChain first = chain(model, 1), second = chain(model, 2);
  const auto probability = [](const LossChain& of, std::size_t a, std::size_t b, std::size_t c) {
    const auto i = static_cast<Eigen::Index>(a), j = static_cast<Eigen::Index>(b), k = static_cast<Eigen::Index>(c);
    return of.stationary()(i) * of.transition()(i, j) * of.transition()(j, k);
  };
  double most = 0.0;
  std::size_t compared = 0;
  for (std::size_t path = 0; path < 8 * 64; ++path) {
    const Modes both = {static_cast<std::uint8_t>(path & 1),      static_cast<std::uint8_t>(path >> 1 & 1),
                        static_cast<std::uint8_t>(path >> 2 & 1), static_cast<std::uint8_t>(path >> 3 & 3),
                        static_cast<std::uint8_t>(path >> 5 & 3), static_cast<std::uint8_t>(path >> 7 & 3)};
    bool is_rare = false;
    for (std::size_t k = 0; k < 6; ++k) is_rare = is_rare || (k < 3 ? both[k] == 1 : both[k] % 2 == 1);
    if (!is_rare) {
      EXPECT_EQ(sums.count(both), 0u);
      continue;
    }
    const double known = probability(first, both[0], both[1], both[2]) * probability(second, both[3], both[4], both[5]);
    const double n = kPaths, mean = sums[both] / n;
    const double error = std::sqrt((squares[both] / n - mean * mean) / n);
    // 448 comparisons: 5 standard errors are beyond the largest of them in 3e-4 of cases. Too rare paths are not
    // normal.
    if (squares[both] == 0.0 || known < 100.0 * losses.expected() / n) continue;
    EXPECT_NEAR(mean, known, 5.0 * error) << path;
    most = std::max(most, known);
    ++compared;
  }
  EXPECT_GT(compared, 50u);
  EXPECT_GT(most, 0.005);
}

TEST(RareLosses, AreFoundInAnyRealizations) {
  const PlatoonModel model = two_links();
  const RareLosses losses(model, 2, kSteps);
  std::vector<double> weights(kPaths);
  std::vector<std::int64_t> begins(kPaths);
  losses.weights(WhiteNoise(9), 0, kPaths, weights.data(), begins.data());
  const std::vector<Modes> found = modes(model, WhiteNoise(9));
  for (std::size_t s = 0; s < kPaths; ++s) {
    const Modes& of = found[s];
    const bool is_rare = of[0] == 1 || of[1] == 1 || of[2] == 1 || of[3] % 2 == 1 || of[4] % 2 == 1 || of[5] % 2 == 1;
    ASSERT_EQ(std::isfinite(weights[s]), is_rare) << s;
    std::int64_t step = 0;
    while (step < kSteps && of[static_cast<std::size_t>(step)] != 1 && of[static_cast<std::size_t>(step + 3)] % 2 != 1)
      ++step;
    ASSERT_EQ(begins[s], step < kSteps ? step : RareLosses::kNever) << s;
  }
}

TEST(RareLosses, CountWhatFewPathsHave) {
  LossModel loss{1e-4, 5.0, {1.0}};
  const RareLosses chain(lossy_platoon(loss), 3, 101);
  const double begins = 1e-4 + 100.0 * 1e-4 / 5.0;  // of one link: after an arrival with q / (b (1 - q))
  EXPECT_NEAR(chain.expected(), 3.0 * begins, 1e-12);
  EXPECT_NEAR(chain.unseen(1000, 20).probability, 3.0 * 3.0 * begins / 20000.0, 1e-12);  // two of them, at most
  EXPECT_NEAR(chain.unseen(1000, 20).realizations, 5.0 / 1e-4, 1.0 / begins);            // of a beginning at one step
  EXPECT_NEAR(chain.unseen(100, 20).probability, 0.5 * std::pow(3.0 * begins, 2), 1e-12);
  EXPECT_NEAR(chain.unseen(100, 20).realizations, 1.0 / begins, 1e-6);

  loss.by_distance = LossByDistance({{10.0, 0.0}, {50.0, 1e-4}});
  const RareLosses by_distance(lossy_platoon(loss), 3, 101);
  EXPECT_TRUE(by_distance.empty());
  EXPECT_NEAR(by_distance.unseen(100, 20).probability, 3.0 * begins, 1e-12);
}

}  // namespace
}  // namespace platoon
