// Strings with radios: Gamma and its noise sources, from the verdict to the tables.

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "stochastic_platoon/math/links/linked_moments.hpp"
#include "stochastic_platoon/math/numerics/special_values.hpp"
#include "stochastic_platoon/math/simulation/ensemble_run.hpp"
#include "stochastic_platoon/math/statistics/agreement.hpp"
#include "stochastic_platoon/math/string/critical_headway.hpp"
#include "stochastic_platoon/math/string/critical_loss.hpp"
#include "stochastic_platoon/math/string/error_moments.hpp"
#include "stochastic_platoon/math/string/linked_string.hpp"
#include "stochastic_platoon/math/string/stationary_variance.hpp"
#include "stochastic_platoon/math/string/string_stability.hpp"
#include "unit/agreement_of.hpp"
#include "unit/math/radio_cars.hpp"
#include "unit/monte_carlo.hpp"

namespace platoon {
namespace {

// Reference: figures of an independent program.
TEST(FeedForward, HasTheVariancesOfAnIndependentProgram) {
  struct Case {
    double radar, radio, first, twentieth, limit;
  };
  for (const Case& expected :
       {Case{0.01, 0.0, 6.09127e-5, 6.09966e-5, 6.10082e-5}, Case{0.0, 0.01, 3.95366e-4, 3.95542e-4, 3.95614e-4}}) {
    const PlatoonModel model = radio_platoon(0.5, expected.radar, expected.radio);
    const std::vector<double> variances = stationary_variances(model, 20);
    const StringStability verdict = string_stability(model);
    EXPECT_NEAR(variances.front() / expected.first, 1.0, 1e-5);
    EXPECT_NEAR(variances.back() / expected.twentieth, 1.0, 1e-5);
    ASSERT_TRUE(verdict.string_stable) << verdict.reason;
    EXPECT_NEAR(*verdict.limit_variance / expected.limit, 1.0, 1e-5);
  }
}

TEST(FeedForward, HasTheCriticalHeadwayOfAnIndependentProgram) {
  const std::optional<StableHeadways> headways = stable_headways(radio_platoon(0.5, 0.01, 0.01));
  ASSERT_TRUE(headways && headways->critical);
  EXPECT_NEAR(0.01 * *headways->critical / 0.247542, 1.0, 1e-5);
  EXPECT_TRUE(string_stability(radio_platoon(0.2476, 0.01, 0.01)).string_stable);
  EXPECT_FALSE(string_stability(radio_platoon(0.2475, 0.01, 0.01)).string_stable);
}

// The verdict's factors and the values of the spectra come from different computations.
TEST(FeedForward, HasTheSameGammaByFactorsAndByFormula) {
  for (const std::int64_t delay : {1, 2, 25, 60}) {
    const PlatoonModel model = radio_platoon(0.5, 0.01, 0.01, delay);
    const LinkedPattern pattern(model);
    const LinkedVehicle& vehicle = pattern.types.front();
    const RatedFactor& factor = vehicle.factor();
    const auto gain = [&](double w) {  // |Gamma|^2 from poles and zeros, 1 at w = 0
      long double value = 1.0L;
      const std::complex<long double> s(std::cos(static_cast<long double>(w)) - 1.0L,
                                        std::sin(static_cast<long double>(w)));
      for (const auto& zero : factor.factor.zeros) value *= std::norm(s - zero) / std::norm(zero);
      for (const auto& pole : factor.factor.poles) value *= std::norm(pole) / std::norm(s - pole);
      return static_cast<double>(value);
    };
    for (const double w : {1e-4, 0.003, 0.05, 0.7, 2.0, 3.1}) {
      const LinkedVehicleValue value = vehicle.at(w);
      EXPECT_NEAR(value.gain / gain(w), 1.0, 1e-10) << delay << " " << w;
      EXPECT_NEAR(value.margin, 1.0 - value.gain, 1e-15 + 1e-12 * value.gain) << delay << " " << w;
    }
  }
}

// What a follower hears is the input of its predecessor, whose plant may be another one.
TEST(FeedForward, HasTheSameGammaByFactorsAndByFormulaBehindUnlikePlants) {
  for (const double lag : {0.0, 0.25}) {
    for (const double delay : {0.0, 0.2, 0.333}) {
      PlatoonModel model = radio_platoon(0.5, 0.01, 0.01, 3);
      add_trucks(model, lag, delay, 0.7);
      const LinkedPattern pattern(model);
      EXPECT_EQ(pattern.types.size(), 5U);
      for (const double w : {1e-4, 0.003, 0.05, 0.7, 2.0, 3.1}) {
        const std::complex<long double> s(std::cos(static_cast<long double>(w)) - 1.0L,
                                          std::sin(static_cast<long double>(w)));
        long double by_factors = 1.0L, by_formula = 1.0L;
        for (std::size_t j = 0; j < pattern.size(); ++j) {
          const GainFactor& factor = pattern[j].factor().factor;
          for (const auto& zero : factor.zeros) by_factors *= std::norm(s - zero) / std::norm(zero);
          for (const auto& pole : factor.poles) by_factors *= std::norm(pole) / std::norm(s - pole);
          const LinkedVehicleValue value = pattern[j].at(w);
          by_formula *= value.gain;
          EXPECT_NEAR(value.margin, 1.0 - value.gain, 1e-15 + 1e-12 * value.gain) << lag << " " << delay << " " << w;
        }
        EXPECT_NEAR(static_cast<double>(by_formula / by_factors), 1.0, 1e-10) << lag << " " << delay << " " << w;
      }
    }
  }
}

TEST(FeedForward, SettlesAtTheStationaryVariancesBehindUnlikePlants) {
  for (const double lag : {0.0, 0.25}) {
    for (const double loss : {0.0, 0.2}) {
      PlatoonModel model = radio_platoon(0.5, 0.01, 0.02);
      add_trucks(model, lag, 0.213, 0.9);
      if (loss > 0.0) lose_inputs(model, loss, {1.0});
      constexpr std::size_t kFollowers = 7;
      const std::vector<double> stationary = stationary_variances(model, kFollowers);
      const SignalMoments moments = error_moments(model, kFollowers, 6000);
      for (std::size_t i = 1; i <= kFollowers; ++i)
        EXPECT_NEAR(moments.variance_at(i, 5999) / stationary[i - 1], 1.0, 1e-9) << i << " " << lag << " " << loss;
      const StringStability verdict = string_stability(model);
      EXPECT_LE(stationary.back(), verdict.limit_variance.value_or(kInfinity));
    }
  }
}

TEST(FeedForward, SettlesAtTheStationaryVariances) {
  for (const bool humans : {false, true}) {
    for (const double loss : {0.0, 0.2}) {
      for (const std::vector<double>& predictor : {std::vector<double>{1.0}, {2.0, -1.0}, {}}) {
        PlatoonModel model = radio_platoon(0.5, 0.01, 0.02);
        if (loss > 0.0) lose_inputs(model, loss, predictor);
        if (humans) add_human_drivers(model);
        constexpr std::size_t kFollowers = 5;
        const std::vector<double> stationary = stationary_variances(model, kFollowers);
        const SignalMoments moments = error_moments(model, kFollowers, 6000);
        for (std::size_t i = 1; i <= kFollowers; ++i) {
          EXPECT_NEAR(moments.variance_at(i, 5999) / stationary[i - 1], 1.0, 1e-9) << i << " " << loss << humans;
        }
        if (loss == 0.0) break;
      }
    }
  }
}

TEST(FeedForward, SharesTheVarianceAmongTheInputs) {
  PlatoonModel model = radio_platoon(0.5, 0.01, 0.02);
  lose_inputs(model, 0.1, {1.0});
  const std::vector<double> all = stationary_variances(model, 8);
  const std::vector<std::vector<double>> shares = stationary_variances_by_input(*StringTheory::of(model), 8);
  const std::vector<double> radar = stationary_variances(radio_platoon(0.5, 0.01, 0.0), 8);
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_NEAR((shares[i][0] + shares[i][1]) / all[i], 1.0, 1e-11);
    EXPECT_GT(shares[i][1], shares[i][0]);
  }
  // Lost inputs count towards the radio, even if the noise of the radar further ahead caused these inputs.
  PlatoonModel lossless = radio_platoon(0.5, 0.01, 0.02);
  EXPECT_NEAR(stationary_variances_by_input(*StringTheory::of(lossless), 8).back()[0] / radar.back(), 1.0, 1e-11);
}

TEST(FeedForward, MayLoseSomeInputs) {
  int judged = 0;
  for (const std::vector<double>& predictor : {std::vector<double>{1.0}, {2.0, -1.0}, {}}) {
    // Without a prediction the mean feed-forward is p, and needs a longer headway.
    PlatoonModel model = radio_platoon(predictor.empty() ? 2.0 : 0.5, 0.01, 0.01);
    lose_inputs(model, 0.05, predictor);
    model.types.front().inherited.loss_probability = true;
    const StringStability verdict = string_stability(model);
    ASSERT_TRUE(verdict.loss_gain) << verdict.reason;
    const std::optional<StableLosses> losses = stable_losses(model);
    ASSERT_TRUE(losses);
    ASSERT_FALSE(losses->intervals.empty());
    if (!losses->critical) continue;
    ++judged;
    EXPECT_TRUE(string_stability(with_loss(model, 0.999 * *losses->critical)).string_stable);
    EXPECT_FALSE(string_stability(with_loss(model, 1.001 * *losses->critical)).string_stable);
  }
  EXPECT_GE(judged, 1);
}

// The variance of the mean of R squared normal errors is known.
TEST(FeedForward, AgreesWithAMonteCarlo) {
  constexpr std::size_t kFollowers = 4;
  constexpr std::int64_t kSteps = 150;
  for (const double loss : {0.0, 0.2}) {
    PlatoonModel model = radio_platoon(0.5, 0.01, 0.02);
    model.default_vehicle().initial_position = {0.3, 0.04};
    if (loss > 0.0) lose_inputs(model, loss, {1.0});
    add_human_drivers(model);
    std::vector<double> cumulants;
    const SignalMoments theory = loss > 0.0 ? linked_error_moments(model, kFollowers, kSteps, &cumulants)
                                            : error_moments(model, kFollowers, kSteps);
    const EnsembleTotals measured = monte_carlo(model, {7, kFollowers, kSteps, 500}, 4000, 2);
    std::vector<double> fourth;
    for (std::size_t c = 0; c < cumulants.size(); ++c)
      fourth.push_back(3.0 * theory.variance[c] * theory.variance[c] + cumulants[c]);
    const Agreement found = agreement_of(measured.moments.totals(), theory.mean, theory.variance, 1e-9, fourth);
    EXPECT_TRUE(found.agrees()) << found.max_abs_z_mean << " " << found.max_abs_z_variance;
  }
}

TEST(FeedForward, LeavesNoErrorAtConstantSpeed) {
  PlatoonModel model = radio_platoon(0.5, 0.0, 0.0);
  const SignalMoments moments = error_moments(model, 3, 8000);
  for (std::size_t i = 1; i <= 3; ++i) EXPECT_NEAR(moments.mean_at(i, 7999), 0.0, 1e-9);
}

}  // namespace
}  // namespace platoon
