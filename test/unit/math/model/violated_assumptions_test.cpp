#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "stochastic_platoon/math/model/loop_assumptions.hpp"
#include "unit/math/model/fractions.hpp"
#include "unit/messages.hpp"
#include "unit/paper_platoon.hpp"

namespace platoon {
namespace {

bool any_contains(const std::vector<std::string>& texts, const std::string& part) {
  return std::any_of(texts.begin(), texts.end(),
                     [&](const std::string& text) { return text.find(part) != std::string::npos; });
}

TEST(ViolatedAssumptions, NameTheMissingDoubleIntegralAction) {
  const TransferFunction controller = fraction(0.05, {0.0}, {-0.89});
  for (const Zeros& poles : {Zeros{1.0, 0.5}, Zeros{0.5, 0.6}, Zeros{{0.9, 0.3}}}) {
    const std::vector<std::string> found =
        violated_assumptions(close_loop({fraction(1.0, {}, poles), controller}, 3.2), 3.2, true);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_TRUE(contains(found[0],
                         "no double integral action: G(z) K(z) must have two poles at z = 1, that is T(1) = 1 and "
                         "dT/dz(1) = -h for h = 3.2; here T(1) = "));
  }
  // A controller zero at 1 cancels one of the plant's two integrators.
  const ClosedLoop loop = close_loop({fraction(0.1, {}, {1.0, 1.0}), fraction(1.0, {1.0}, {0.2})}, 3.2);
  EXPECT_TRUE(any_contains(violated_assumptions(loop, 3.2, true), "no double integral action"));
}

TEST(ViolatedAssumptions, AllowTripleIntegralAction) {
  const ClosedLoop loop = close_loop({fraction(0.02, {}, {1.0, 1.0}), fraction(1.0, {0.97, 0.9}, {1.0, 0.1})}, 5.0);
  EXPECT_TRUE(violated_assumptions(loop, 5.0, false).empty());
}

// A vehicle with drag (time constant 50 s) and engine lag (0.3 s), sampled at 200 Hz, has one integrator
// only.
TEST(ViolatedAssumptions, NameTheMissingDoubleIntegralActionAtFastSampling) {
  const TransferFunction plant = fraction(1e-6, {}, {1.0, 0.9999, 0.983});
  const ClosedLoop loop = close_loop({plant, fraction(1.0, {0.99}, {0.5})}, 200.0);
  EXPECT_TRUE(any_contains(violated_assumptions(loop, 200.0, true), "no double integral action"));
}

// T(1) = 1, yet dT/dz(1) is half the value that a ramp requires: three closed loop poles at 0.97.
TEST(ViolatedAssumptions, NameTheMissingDoubleIntegralActionOfASlowLoop) {
  const Polynomial d = polynomial_with_zeros({0.97, 0.97, 0.97});
  const ClosedLoop loop = closed_loop_from(observable_canonical(ramp_tracking(d, 0.5)));
  ASSERT_TRUE(violated_assumptions(loop, 0.5, false).empty());
  EXPECT_TRUE(any_contains(violated_assumptions(loop, 1.0, false), "no double integral action"));
}

TEST(ViolatedAssumptions, AllowARealizationWithSixDigits) {
  const auto rounded = [](double value) { return std::stod(std::to_string(value)); };
  const StateSpace paper = paper_loop(3.2).realization;
  const StateSpace given(paper.a().unaryExpr(rounded), paper.b().unaryExpr(rounded), paper.c());
  EXPECT_TRUE(violated_assumptions(closed_loop_from(given), 3.2, false).empty());
}

TEST(ViolatedAssumptions, NameAnUnstableLoopUnlessItIsAllowed) {
  const ClosedLoop loop = close_loop({fraction(1.0, {}, {1.0, 1.0}), fraction(3.0, {0.0}, {-0.89})}, 3.2);
  ASSERT_GT(spectral_radius(loop.realization), 1.0);
  const std::vector<std::string> found = violated_assumptions(loop, 3.2, false);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_TRUE(begins_with(found[0], "the closed loop is unstable: rho(A) = "));
  EXPECT_TRUE(contains(found[0], "must be < 1 (allow_unstable: true runs it anyway)"));
  EXPECT_TRUE(violated_assumptions(loop, 3.2, true).empty());
}

TEST(ViolatedAssumptions, NameAHiddenUnstableModeUnlessItIsAllowed) {
  const ClosedLoop real =
      close_loop({fraction(0.02, {}, {1.0, 1.0, 1.25}), fraction(1.0, {0.9, 1.25}, {0.1, -0.2})}, 5.0);
  ASSERT_LT(spectral_radius(real.realization), 1.0);
  EXPECT_EQ(violated_assumptions(real, 5.0, false),
            std::vector<std::string>{"G(z) K(z) cancels an unstable mode at z = 1.25: cancelled modes must lie inside "
                                     "the unit circle (allow_unstable: true runs it anyway)"});
  EXPECT_TRUE(violated_assumptions(real, 5.0, true).empty());
  const std::complex<double> mode(0.75, 1.0);
  const ClosedLoop pair =
      close_loop({fraction(0.02, {}, {1.0, 1.0, mode}), fraction(1.0, {0.9, mode}, {0.1, -0.2, 0.3})}, 5.0);
  const std::vector<std::string> found = violated_assumptions(pair, 5.0, false);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_TRUE(contains(found[0], "at z = 0.75 +- i 1:"));
}

// The controller's zero at 1 cancels the plant's third integrator; the mode's modulus is 1 up to rounding.
TEST(ViolatedAssumptions, NameAHiddenModeOnTheUnitCircle) {
  int silent = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const double pole = -0.5 + 0.01 * trial;
    const ClosedLoop loop =
        close_loop({fraction(0.02, {}, {1.0, 1.0, 1.0}), fraction(1.0, {1.0, 0.9}, {pole, -0.2})}, 5.0);
    ASSERT_EQ(loop.hidden_modes.size(), 1u);
    if (!any_contains(violated_assumptions(loop, 5.0, false), "cancels an unstable mode at z = 1")) ++silent;
  }
  EXPECT_EQ(silent, 0) << "of 100 loops";
}

TEST(ViolatedAssumptions, AllowAHiddenStableMode) {
  const ClosedLoop loop =
      close_loop({fraction(0.02, {}, {1.0, 1.0, 0.8}), fraction(1.0, {0.9, 0.8}, {0.1, -0.2})}, 5.0);
  EXPECT_EQ(loop.hidden_modes.size(), 1u);
  EXPECT_TRUE(violated_assumptions(loop, 5.0, false).empty());
}

TEST(ViolatedAssumptions, NameAMissingEquilibrium) {
  Eigen::Matrix2d a;
  a << 1.0, 0.1, 0.0, 0.5;
  const ClosedLoop integrator = closed_loop_from({a, Eigen::Vector2d(0.0, 1.0), Eigen::RowVector2d(1.0, 0.0)});
  EXPECT_TRUE(any_contains(violated_assumptions(integrator, 3.2, true), "A: has an eigenvalue at 1"));
  const ClosedLoop blocked = closed_loop_from(observable_canonical(fraction(0.1, {1.0}, {0.5, 0.2})));
  const std::vector<std::string> found = violated_assumptions(blocked, 3.2, false);
  EXPECT_TRUE(any_contains(found, "T(1) = 0: no equilibrium with output 1 exists"));
  EXPECT_TRUE(any_contains(found, "no double integral action"));
}

TEST(ViolatedAssumptions, NameBothGainsOfAMissingIntegrator) {
  const ClosedLoop loop = close_loop({fraction(0.05, {}, {1.0, 0.5}), fraction(1.0, {0.3}, {0.1})}, 3.0);
  const std::vector<std::string> found = violated_assumptions(loop, 3.0, true);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_TRUE(contains(found[0], "here T(1) = 1 and dT/dz(1) = "));
  EXPECT_TRUE(contains(found[0], "G(z) K(z) has 1 pole there"));
}

TEST(ViolatedAssumptions, NameALoopThatIsTooSlowForItsSamplePeriod) {
  const ClosedLoop loop = close_loop({fraction(1.0, {}, {1.0, 1.0}), fraction(1.35, {0.0}, {-0.89}), true}, 1e15);
  EXPECT_TRUE(any_contains(violated_assumptions(loop, 1e15, false), "too slow for its sample period"));
}

// The pole of the integral lies 5e-13 beside z = 1, and the loop has an equilibrium: only its digits are lost.
TEST(ViolatedAssumptions, NameThePrecisionAndNotAPoleAtOneOfASlowIntegral) {
  const LoopDesign design{Plant(car_with_actuator_lag(0.1, 0.0), 1e-4),
                          Controller(ControllerGains{0.2, 0.7, 1e-9}, 1e-4)};
  const std::vector<std::string> found = violated_assumptions(close_loop(design, 35000.0), 35000.0, false);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_TRUE(begins_with(found[0], "the closed loop is too slow for its sample period: a pole lies 5"));
  EXPECT_TRUE(contains(found[0], "e-13 beside z = 1"));
}

}  // namespace
}  // namespace platoon
