#include "stochastic_platoon/math/string/string_stability.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "stochastic_platoon/math/string/stationary_variance.hpp"
#include "unit/math/example_loops.hpp"
#include "unit/math/paper/spectrum.hpp"
#include "unit/messages.hpp"
#include "unit/sensitivity.hpp"

namespace platoon {
namespace {

using Complex = std::complex<double>;

StringStability verdict_of(const ExampleLoop& example) {
  return string_stability(model_with(example.loop, example.headway));
}

/// |T|^2 = 1 / (1 + c x ((x - x_0)^2 + gap)), x = 1 - cos w: |T| comes nearest to 1 at x_0, where it is
/// 1 / sqrt(1 + c x_0 gap).
ExampleLoop touching_at(double x0, double c, double gap) {
  Polynomial p(4);
  p << c, -2.0 * c * x0, c * (x0 * x0 + gap), 1.0;
  return with_gain_from("touching", roots(p));
}

TEST(StringStability, JudgesBothExamplesOfThePaper) {
  const StringStability stable = verdict_of({"", 3.2, paper_loop(3.2)});
  EXPECT_NEAR(stable.spectral_radius, 0.5274, 5e-5);  // the paper prints 0.5315
  EXPECT_TRUE(stable.mean_square_stable && stable.mean_bounded && stable.string_stable) << stable.reason;
  EXPECT_EQ(stable.peak_gain, 1.0);
  EXPECT_EQ(stable.peak_frequency, 0.0);
  const StringStability unstable = verdict_of({"", 2.4, paper_loop(2.4)});
  EXPECT_NEAR(unstable.spectral_radius, 0.6546, 5e-5);  // the paper prints 0.6531
  EXPECT_TRUE(unstable.mean_square_stable);
  EXPECT_FALSE(unstable.mean_bounded || unstable.string_stable);
  EXPECT_FALSE(unstable.limit_variance.has_value());
  EXPECT_TRUE(contains(unstable.reason, "exceeds 1"));
}

TEST(StringStability, HasItsPeakAboveAGrid) {
  for (const ExampleLoop& example : example_loops()) {
    const StringStability verdict = verdict_of(example);
    for (int i = 0; i <= 5000; ++i) {
      const double gain = std::abs(example.loop.transfer(std::polar(1.0, 3.141592653589793 * i / 5000)));
      EXPECT_LE(gain, verdict.peak_gain * (1.0 + 1e-10)) << example.name << " at " << i;
    }
    const double there = std::abs(example.loop.transfer(std::polar(1.0, verdict.peak_frequency)));
    EXPECT_NEAR(there, verdict.peak_gain, 1e-10 * verdict.peak_gain) << example.name;
  }
}

TEST(StringStability, IsRightOneBillionthEitherSideOfTheBorderAtZeroFrequency) {
  // 1 - |T|^2 ~ (h (1+h) - 2 / K(1)) w^2 for G = 1/(z-1)^2, K(1) = 1.35 / (1.89 (1+h)): h = 2 * 1.89 / 1.35.
  const double border = 2.0 * 1.89 / 1.35;
  EXPECT_TRUE(verdict_of({"", border + 1e-9, paper_loop(border + 1e-9)}).string_stable);
  EXPECT_FALSE(verdict_of({"", border - 1e-9, paper_loop(border - 1e-9)}).mean_bounded);
}

TEST(StringStability, IsRightOneBillionthEitherSideOfTheBorderAtAnIsolatedFrequency) {
  for (const double x0 : {0.01, 0.3, 1.0, 1.7, 2.0}) {
    for (const double c : {0.1, 3.0}) {
      const double gap = 2e-9 / (c * x0);  // |T| is 1 - 1e-9 or 1 + 1e-9 at x_0
      const StringStability below = verdict_of(touching_at(x0, c, gap));
      EXPECT_TRUE(below.string_stable) << x0 << " " << c << ": " << below.reason;
      const StringStability above = verdict_of(touching_at(x0, c, -gap));
      EXPECT_FALSE(above.mean_bounded) << x0 << " " << c << ": " << above.reason;
      EXPECT_NEAR(above.peak_gain, 1.0 + 1e-9, 1e-11) << x0 << " " << c;
    }
  }
}

// The coefficients are rounded: whether |T| touches 1 is below their digits.
TEST(StringStability, IsUndecidedForAGainOfOneAtAnIsolatedFrequency) {
  for (const double x0 : {0.3, 1.0, 1.7, 2.0}) {
    const StringStability verdict = verdict_of(touching_at(x0, 1.0, 0.0));
    EXPECT_TRUE(verdict.mean_bounded) << x0 << ": " << verdict.reason;
    EXPECT_TRUE(verdict.undecided) << x0 << ": " << verdict.reason;
    EXPECT_FALSE(verdict.decision()) << x0;
    EXPECT_TRUE(begins_with(verdict.reason, "undecided: |T| is 1 at "));
    EXPECT_FALSE(verdict.limit_variance.has_value()) << x0;
    EXPECT_EQ(verdict.peak_gain, 1.0);
    EXPECT_NEAR(verdict.peak_frequency, std::acos(1.0 - x0), 1e-6) << x0;
  }
}

TEST(StringStability, OfAPureDelayBoundsTheMeanOnly) {
  const TransferFunction delay(Polynomial::Ones(1), Eigen::Vector2d(1.0, 0.0));
  const StringStability verdict = verdict_of({"", 1.0, closed_loop_from(observable_canonical(delay))});
  EXPECT_TRUE(verdict.mean_bounded) << verdict.reason;
  EXPECT_EQ(verdict.decision(), false) << verdict.reason;
}

// Twenty poles of modulus 0.9 about +-j, where |T| is tiny compared with the terms of its polynomials.
TEST(StringStability, IsDecidedForTwentyPolesNearTheImaginaryAxis) {
  Zeros zeros{0.9, 0.85, 0.8, 0.75};
  for (int i = 0; i < 8; ++i) zeros.push_back(std::polar(0.35 + 0.01 * i, 1.45 + 0.03 * i));
  const ExampleLoop stable = all_pole("twenty poles", polynomial_with_zeros(zeros));
  const StringStability verdict = verdict_of(stable);
  double largest = 0.0;
  for (int i = 1; i <= 20000; ++i)
    largest = std::max(largest, std::abs(stable.loop.transfer(std::polar(1.0, 3.141592653589793 * i / 20000))));
  ASSERT_LT(largest, 1.0);
  EXPECT_EQ(verdict.decision(), true) << verdict.reason;
}

// The excess is below the digits of |T|, and close to w = 0.
TEST(StringStability, HasAReasonWithTheExcess) {
  const StringStability verdict = verdict_of({"", 2.8 - 1e-7, paper_loop(2.8 - 1e-7)});
  EXPECT_EQ(verdict.decision(), false);
  EXPECT_FALSE(contains(verdict.reason, "exceeds 1 by 0 "));
  EXPECT_FALSE(contains(verdict.reason, "at 0 rad"));
}

TEST(StringStability, HasTheLimitOfTheSpectralFactor) {
  for (const ExampleLoop& example : string_stable_loops()) {
    const PlatoonModel model = model_with(example.loop, example.headway);
    const StringStability verdict = string_stability(model);
    ASSERT_TRUE(verdict.string_stable) << example.name << ": " << verdict.reason;
    // S/M = (z-1)^2 Q / (z F), F = (z-1)^m F_1 of M = F/D: the zeros at z = 1 divided out by hand.
    const Polynomial f = spectral_factor(model).numerator();
    Polynomial s = sensitivity(example.loop.transfer, example.headway).numerator();
    Polynomial rest = f;
    const int zeros = multiplicity_at_one(f);
    for (int i = 0; i < zeros; ++i) {
      for (Eigen::Index k = 1; k < rest.size(); ++k) rest(k) += rest(k - 1);
      for (Eigen::Index k = 1; k < s.size(); ++k) s(k) += s(k - 1);
      rest.conservativeResize(rest.size() - 1);
      s.conservativeResize(s.size() - 1);
    }
    const double norm = h2_norm({s, multiply(rest, Eigen::Vector2d(1.0, 0.0))});
    const double limit = (norm * norm - 1.0) * model.default_vehicle().position().noise_variance;
    // S and M by coefficients lose digits where the poles are slow; the limit itself does not.
    const double slowness = 1.0 - verdict.spectral_radius;
    const double tolerance = 1e-11 + 1e-15 / (slowness * slowness);
    EXPECT_NEAR(*verdict.limit_variance, limit, tolerance * limit) << example.name;
  }
}

TEST(StringStability, HasTheLimitOfTheVariances) {
  const PlatoonModel model = model_with(paper_loop(3.2), 3.2);
  const std::vector<double> variances = stationary_variances(model, 100000);
  const double limit = *string_stability(model).limit_variance;
  // P_N misses the limit by a term of order N^{-3/2}: its factor is the same at 10^4 and 10^5.
  const double near = (limit - variances[9999]) * std::pow(1e4, 1.5);
  const double far = (limit - variances[99999]) * std::pow(1e5, 1.5);
  EXPECT_GT(far, 0.0);
  EXPECT_NEAR(far / near, 1.0, 1e-3);
}

TEST(StringStability, HasNoLimitForAGainFlatterThanTheSensitivity) {
  // |T|^2 = 1 / (1 + x^3 / 8): 1 - |T|^2 ~ w^6 while |S|^2 ~ w^4, so P_N grows as N^{1/6}.
  std::vector<Complex> zeros;
  for (int i = 0; i < 3; ++i) zeros.push_back(std::polar(2.0, 3.141592653589793 * (2 * i + 1) / 3.0));
  const ExampleLoop flat = with_gain_from("flat", zeros);
  const StringStability verdict = verdict_of(flat);
  EXPECT_TRUE(verdict.mean_bounded) << verdict.reason;
  EXPECT_FALSE(verdict.string_stable) << verdict.reason;
  EXPECT_FALSE(verdict.limit_variance.has_value());
  const std::vector<double> variances = stationary_variances(model_with(flat.loop, flat.headway), 1 << 16);
  const auto increment = [&](std::size_t i) { return variances[i] - variances[i - 1]; };
  EXPECT_NEAR(increment(1 << 12) / increment((1 << 16) - 1), 10.08, 0.9);  // 16^{5/6}; 16^{3/2} with a limit
}

TEST(StringStability, HasALimitProportionalToTheNoise) {
  PlatoonModel model = model_with(paper_loop(3.2), 3.2);
  const double limit = *string_stability(model).limit_variance;
  model.default_vehicle().position().noise_variance = 0.0;
  EXPECT_EQ(*string_stability(model).limit_variance, 0.0);
  model.default_vehicle().position().noise_variance = 1.2;
  EXPECT_NEAR(*string_stability(model).limit_variance, 2.0 * limit, 1e-15 * limit);
}

TEST(StringStability, HasNoGainAndNoLimitForAnUnstableVehicle) {
  const TransferFunction t = ramp_tracking(polynomial_with_zeros({1.05, 0.2}), 2.0);
  const StringStability verdict = verdict_of({"", 2.0, closed_loop_from(observable_canonical(t))});
  EXPECT_FALSE(verdict.mean_square_stable || verdict.mean_bounded || verdict.string_stable);
  EXPECT_TRUE(std::isnan(verdict.peak_gain) && std::isnan(verdict.peak_frequency));
  EXPECT_FALSE(verdict.limit_variance.has_value());
  EXPECT_TRUE(contains(verdict.reason, "rho(A) = 1.05"));
}

}  // namespace
}  // namespace platoon
