#include "stochastic_platoon/math/string/linked_string.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "stochastic_platoon/math/links/linked_moments.hpp"
#include "stochastic_platoon/math/string/critical_loss.hpp"
#include "stochastic_platoon/math/string/error_moments.hpp"
#include "stochastic_platoon/math/string/stationary_variance.hpp"
#include "stochastic_platoon/math/string/string_stability.hpp"
#include "unit/math/example_loops.hpp"
#include "unit/math/lossy_platoon.hpp"
#include "unit/messages.hpp"

namespace platoon {
namespace {

// Reference: the sums for the paper's platoon, in double.
TEST(LinkedString, WithoutLossesHasTheErrorsOfThePaper) {
  for (const double headway : {2.4, 3.2}) {
    const PlatoonModel model = paper_platoon(headway);
    const SignalMoments expected = error_moments(model, 5, 40), found = linked_error_moments(model, 5, 40);
    for (std::size_t c = 0; c < expected.variance.size(); ++c) {
      EXPECT_NEAR(found.variance[c], expected.variance[c], 1e-12 * expected.variance.back());
      EXPECT_NEAR(found.mean[c], expected.mean[c], 1e-11);
    }
  }
}

// A string of two types with the same vehicle is homogeneous.
TEST(LinkedString, OfEqualTypesIsHomogeneous) {
  const PlatoonModel model = lossy_platoon({0.2, {}, {2.0, -1.0}});
  PlatoonModel patterned = model;
  patterned.types.push_back({"twin", vehicle(model, 1)});
  patterned.string = {0, 1, 1};
  const StringStability one = string_stability(model), other = string_stability(patterned);
  EXPECT_NEAR(*other.loss_gain, *one.loss_gain, 1e-10);
  EXPECT_NEAR(*other.limit_variance / *one.limit_variance, 1.0, 1e-9);
  const SignalMoments expected = linked_error_moments(model, 7, 30), found = linked_error_moments(patterned, 7, 30);
  for (std::size_t c = 0; c < expected.variance.size(); ++c)
    EXPECT_NEAR(found.variance[c], expected.variance[c], 1e-12 * expected.variance.back());
}

TEST(LinkedString, HasAReasonInOneSentence) {
  EXPECT_TRUE(begins_with(string_stability(lossy_platoon({0.3, {}, {2.0, -1.0}})).reason,
                          "not string stable: the loss gain is "));
  EXPECT_TRUE(begins_with(string_stability(lossy_platoon({0.1, {}, {2.0, -1.0}}, 2.4)).reason,
                          "not string stable: |T^| exceeds 1 by "));
  EXPECT_TRUE(begins_with(string_stability(lossy_platoon({0.4, {}, {2.0, -1.0}})).reason,
                          "not mean square stable: p q ||L F||^2 = "));
  EXPECT_TRUE(begins_with(string_stability(lossy_platoon({0.1, {}, {1.0}})).reason, "string stable: rho(A) = "));
}

TEST(LinkedString, HasALossGainOfZeroForALossProbabilityOfZero) {
  EXPECT_EQ(string_stability(lossy_platoon({0.0, {}, {1.0}})).loss_gain, 0.0);
  EXPECT_FALSE(string_stability(paper_platoon()).loss_gain);
  PlatoonModel delayed = lossy_platoon({0.0, {}, {1.0}});
  delayed.default_vehicle().position().link.delay = 1;
  EXPECT_EQ(string_stability(delayed).loss_gain, 0.0);
}

// Extrapolation settles while p q ||L F||^2 < 1, that is q < 1/3; the string only below the critical loss.
TEST(LinkedString, HasNoStationaryVarianceIfPredictionsGrow) {
  EXPECT_TRUE(std::isfinite(stationary_variances(lossy_platoon({0.333, {}, {2.0, -1.0}}), 1).front()));
  EXPECT_TRUE(std::isnan(stationary_variances(lossy_platoon({0.334, {}, {2.0, -1.0}}), 1).front()));
}

TEST(LinkedString, HasTheMeanOfDelayAndHolding) {
  PlatoonModel model = lossy_platoon({0.25, {}, {1.0}});
  model.default_vehicle().position().link.delay = 3;
  for (const double mean : stationary_means(model, 3)) EXPECT_DOUBLE_EQ(mean, 2.0 * (3.0 + 0.25 / 0.75));
  for (const double mean : stationary_means(lossy_platoon({0.25, {}, {2.0, -1.0}}), 3)) EXPECT_EQ(mean, 0.0);
  EXPECT_TRUE(std::isnan(stationary_means(lossy_platoon({0.4, {}, {2.0, -1.0}}), 1).front()));
}

TEST(StableLosses, SeparateStableFromUnstable) {
  const std::optional<StableLosses> losses = stable_losses(lossy_platoon({0.1, {}, {2.0, -1.0}}));
  ASSERT_TRUE(losses && losses->critical);
  EXPECT_TRUE(string_stability(lossy_platoon({*losses->critical - 1e-9, {}, {2.0, -1.0}})).string_stable);
  EXPECT_FALSE(string_stability(lossy_platoon({*losses->critical + 1e-9, {}, {2.0, -1.0}})).string_stable);
  const std::optional<StableLosses> held = stable_losses(lossy_platoon({0.1, {}, {1.0}}));
  EXPECT_EQ(stable_losses(paper_platoon())->critical, held->critical) << "without a loss stage it holds";
  EXPECT_FALSE(held->critical) << "stable throughout";
  ASSERT_EQ(held->intervals.size(), 1u);
  EXPECT_EQ(held->intervals.front().from, 0.0);
  EXPECT_EQ(held->intervals.front().to, 0.99);
  EXPECT_FALSE(stable_losses(lossy_platoon({0.1, {}, {2.0, -1.0}}, 2.4))->critical) << "unstable without losses";
}

// 1 - |T^|^2 vanishes like w^4. So does abs(1 - H T^)^2 without a delay, and like w^2 with one.
TEST(LinkedString, GrowsForAFlatGainBehindADelay) {
  const ExampleLoop flat = string_stable_loops().back();
  PlatoonModel model = model_with(flat.loop, flat.headway);
  EXPECT_EQ(string_stability(model).decision(), true);
  model.default_vehicle().position().link.delay = 1;
  const StringStability delayed = string_stability(model);
  EXPECT_EQ(delayed.decision(), false);
  EXPECT_TRUE(contains(delayed.reason, "vanishes so fast"));
  const std::vector<double> variances = stationary_variances(model, 4096);
  const double early = variances[1023] - variances[511], late = variances[4095] - variances[2047];
  EXPECT_GT(late, early) << "they grow like N^(1/4)";
}

/// A platoon of finite responses b that lose positions independently and extrapolate.
PlatoonModel extrapolating_platoon(const Eigen::VectorXd& b, double loss) {
  PlatoonModel model = paper_platoon(3.0);
  Eigen::MatrixXd shift = Eigen::MatrixXd::Zero(b.size(), b.size());
  shift.diagonal(1).setOnes();
  model.default_vehicle().loop = closed_loop_from(StateSpace(shift, b, Eigen::VectorXd::Unit(b.size(), 0).transpose()));
  model.default_vehicle().position().link.loss = LossModel{loss, {}, {2.0, -1.0}};
  return model;
}

// With extrapolation abs(1 - L)^2 vanishes like w^4, too: the losses add no more than the string attenuates.
TEST(LinkedString, HasALimitForAFlatGainBehindExtrapolation) {
  Eigen::VectorXd b(5);
  b << -0.075, 0.3526315789473684, 0.4447368421052632, 0.3526315789473684, -0.075;
  const PlatoonModel model = extrapolating_platoon(b, 0.05);
  const LinkedPattern pattern(model);
  ASSERT_EQ(pattern.gain().zeros(), 2);
  EXPECT_EQ(pattern[0].zeros_at_zero().innovation, 2);
  EXPECT_EQ(pattern[0].zeros_at_zero().complement, 2);
  const StringStability verdict = string_stability(model);
  ASSERT_EQ(verdict.decision(), true) << verdict.reason;
  // The distance to the limit decays like N^(-1/4).
  const std::vector<double> variances = stationary_variances(model, 10000);
  const double missing = *verdict.limit_variance - variances[9999], before = *verdict.limit_variance - variances[624];
  EXPECT_NEAR(before / missing, 2.0, 0.1);
  EXPECT_NEAR(variances[9999], 47.64, 0.01);
}

// The model's own probability is the largest stable one, but for rounding.
TEST(StableLosses, ContainTheOwnOneOfAStringStableModelAtItsBorder) {
  Eigen::VectorXd b(5);
  b << -0.01318359375, 0.16881066927792915, 0.6887458489441417, 0.16881066927792915, -0.01318359375;
  const PlatoonModel model = extrapolating_platoon(b, 0.10400390625);
  ASSERT_TRUE(string_stability(model).string_stable);
  const std::optional<StableLosses> losses = stable_losses(model);
  ASSERT_TRUE(losses && losses->critical);
  EXPECT_GE(*losses->critical, 0.10400390625);
  EXPECT_NEAR(*losses->critical, 0.10400390625, 1e-12);
}

// Short delays agree with the table over time; a delay of a million steps takes no longer.
TEST(LinkedString, MayHaveAnyDelay) {
  PlatoonModel model = lossy_platoon({0.2, {}, {1.0}});
  for (const std::int64_t delay : {1, 7, 9, 20, 33}) {
    model.default_vehicle().position().link.delay = delay;
    const std::vector<double> stationary = stationary_variances(model, 3);
    model.default_vehicle().initial_position = {};
    const SignalMoments table = linked_error_moments(model, 3, 400 + 4 * delay);
    for (std::size_t i = 1; i <= 3; ++i)
      EXPECT_NEAR(table.variance_at(i, table.steps - 1) / stationary[i - 1], 1.0, 1e-10) << delay << " " << i;
  }
  model.default_vehicle().position().link.delay = 1000000;
  const std::vector<double> late = stationary_variances(model, 2);
  EXPECT_TRUE(std::isfinite(late[1]));
}

TEST(LinkedTheory, RejectsModelsWithoutTheory) {
  PlatoonModel bursts = lossy_platoon({0.1, {}, {1.0}});
  bursts.default_vehicle().position().link.loss->mean_burst = 3.0;
  EXPECT_THROW(linked_error_moments(bursts, 2, 5), std::invalid_argument);
  EXPECT_THROW(stationary_variances(lossy_platoon({0.1, {}, {1.0}}), 0), std::invalid_argument);
  EXPECT_THROW(linked_error_moments(lossy_platoon({0.1, {}, {1.0}}), 0, 5), std::invalid_argument);
  EXPECT_THROW(linked_error_moments(lossy_platoon({0.1, {}, {1.0}}), 2, 0), std::invalid_argument);
}

/// Errors of two followers that hold lost positions, without noise, behind a leader at one metre per step, for one
/// pattern of losses: bit 2 k + i - 1 is set if the position of step k into follower i is lost.
std::vector<std::vector<double>> errors_of(const PlatoonModel& model, unsigned pattern, std::size_t steps) {
  std::vector<double> ahead;
  for (std::size_t k = 0; k <= steps; ++k) ahead.push_back(static_cast<double>(k));  // from step -1 on
  std::vector<std::vector<double>> errors;
  for (std::size_t i = 0; i < 2; ++i) {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(model.default_vehicle().loop.realization.order());
    double used = ahead.front();
    std::vector<double> own{0.0};
    errors.emplace_back();
    for (std::size_t k = 0; k < steps; ++k) {
      own.push_back(model.default_vehicle().loop.realization.c() * x);
      errors.back().push_back(ahead[k + 1] - own[k + 1] - model.default_vehicle().headway * (own[k + 1] - own[k]));
      if ((pattern >> (2 * k + i) & 1U) == 0) used = ahead[k + 1];
      x = (model.default_vehicle().loop.realization.a() * x + model.default_vehicle().loop.realization.b() * used)
              .eval();
    }
    ahead = own;
  }
  return errors;
}

// Reference: all 2^14 patterns of losses of two links over seven steps.
TEST(LinkedErrorMoments, HaveTheFourthCumulantsOfRareLosses) {
  constexpr std::size_t kSteps = 7;
  PlatoonModel model = lossy_platoon({1e-6, {}, {1.0}});
  model.default_vehicle().position().noise_variance = 0.0;
  for (std::size_t k = 0; k <= kSteps; ++k) model.recorded_leader.push_back(static_cast<double>(k));
  std::vector<double> cumulants;
  const SignalMoments moments = linked_error_moments(model, 2, kSteps, &cumulants);
  std::vector<double> variance(2 * kSteps, 0.0), fourth(2 * kSteps, 0.0);
  for (unsigned pattern = 0; pattern < 1U << (2 * kSteps); ++pattern) {
    const double lost = __builtin_popcount(pattern);
    const double chance = std::pow(1e-6, lost) * std::pow(1.0 - 1e-6, 2.0 * kSteps - lost);
    const auto errors = errors_of(model, pattern, kSteps);
    for (std::size_t c = 0; c < fourth.size(); ++c) {
      const double square = std::pow(errors[c / kSteps][c % kSteps] - moments.mean[c], 2);
      variance[c] += chance * square;
      fourth[c] += chance * square * square;
    }
  }
  ASSERT_EQ(cumulants.size(), fourth.size());
  for (std::size_t c = 0; c < fourth.size(); ++c) {
    EXPECT_NEAR(moments.variance[c], variance[c], 1e-9 * variance[c] + 1e-25) << c;
    EXPECT_NEAR(cumulants[c], fourth[c] - 3.0 * variance[c] * variance[c], 1e-4 * fourth[c] + 1e-25) << c;
  }
  EXPECT_GT(fourth.back(), 1e-8);
}

}  // namespace
}  // namespace platoon
