#include "stochastic_platoon/math/model/closed_loop.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>

#include "stochastic_platoon/math/model/loop_assumptions.hpp"
#include "unit/paper_platoon.hpp"
#include "unit/sensitivity.hpp"
#include "unit/zeros.hpp"

namespace platoon {
namespace {

using Zeros = std::vector<std::complex<double>>;

TransferFunction fraction(double gain, const Zeros& zeros, const Zeros& poles) {
  return {gain * polynomial_with_zeros(zeros), polynomial_with_zeros(poles)};
}

// T = N/D with this D and double integral action: N = D(1) + (D'(1) - h D(1)) (z - 1) + (z - 1)^2 extra.
TransferFunction ramp_tracking(const Polynomial& d, double headway, double extra = 0.0) {
  const double value = d.sum();
  const double slope = derivative(d).sum() - headway * value;
  return {add(Eigen::Vector2d(slope, value - slope), extra * Eigen::Vector3d(1.0, -2.0, 1.0)), d};
}

double distance(const TransferFunction& f, const TransferFunction& g) {
  double largest = 0.0;
  for (int k = 0; k <= 200; ++k) {
    const std::complex<double> z = std::polar(1.0, 3.14159265358979 * k / 200.0);
    largest = std::max(largest, std::abs(f(z) - g(z)) / std::abs(g(z)));
  }
  return largest;
}

bool any_contains(const std::vector<std::string>& texts, const std::string& part) {
  return std::any_of(texts.begin(), texts.end(),
                     [&](const std::string& text) { return text.find(part) != std::string::npos; });
}

TEST(ClosedLoop, OfThePapersExampleHasOrderThreeAndTheseCoefficients) {
  for (const double h : {3.2, 2.4, 4.0}) {
    const ClosedLoop loop = paper_platoon(h).default_vehicle().loop;
    const double k = 1.35 / (1.0 + h);
    ASSERT_EQ(loop.realization.order(), 3);
    ASSERT_EQ(loop.transfer.numerator().size(), 2);
    EXPECT_NEAR(loop.transfer.numerator()(0), k, 1e-15);
    EXPECT_EQ(loop.transfer.numerator()(1), 0.0);
    const Eigen::Vector4d denominator(1.0, -1.11, 1.0 - 2.0 * 0.89 + 1.35, 0.89 - k * h);
    EXPECT_LT((loop.transfer.denominator() - denominator).cwiseAbs().maxCoeff(), 1e-15);
    EXPECT_EQ(loop.hidden_modes, Zeros{0.0});
    EXPECT_TRUE(violated_assumptions(loop, h, false).empty());
  }
}

TEST(ClosedLoop, OfThePapersExampleHasTheseSpectralRadii) {
  EXPECT_NEAR(spectral_radius(paper_platoon(3.2).default_vehicle().loop.realization), 0.5274, 0.00005);
  EXPECT_NEAR(spectral_radius(paper_platoon(2.4).default_vehicle().loop.realization), 0.6546, 0.00005);
}

TEST(ClosedLoop, IsTheFeedbackOfControllerPlantAndHeadway) {
  std::mt19937 generator(1);
  for (int trial = 0; trial < 50; ++trial) {
    const double h = 0.5 + trial % 7;
    const TransferFunction plant(0.1 * random_polynomial(trial % 2, generator),
                                 multiply(polynomial_with_zeros({1.0, 1.0}), random_polynomial(trial % 3, generator)));
    const TransferFunction controller(random_polynomial(1, generator), random_polynomial(1 + trial % 2, generator));
    const ClosedLoop loop = close_loop({plant, controller}, h);
    for (const std::complex<double>& z : {std::complex<double>(1.1, 0.0), {0.5, 2.0}, {-1.7, 0.3}}) {
      const std::complex<double> kg = controller(z) * plant(z);
      const std::complex<double> expected = kg / (1.0 + kg * (1.0 + h - h / z));
      EXPECT_LT(std::abs(loop.transfer(z) - expected), 1e-11 * std::abs(expected));
      EXPECT_LT(std::abs(resolvent(loop.realization).transfer(z) - expected), 1e-11 * std::abs(expected));
    }
  }
}

TEST(ClosedLoop, SensitivityIsOneMinusHT) {
  const ClosedLoop loop = paper_platoon().default_vehicle().loop;
  const std::complex<double> z(0.4, 0.9);
  const TransferFunction s = sensitivity(loop.transfer, 3.2);
  EXPECT_LT(std::abs(s(z) - (1.0 - (4.2 - 3.2 / z) * loop.transfer(z))), 1e-14);
  EXPECT_EQ(multiplicity_at_one(s.numerator()), 2);
}

// Factors that cancel between plant and controller change neither T nor its order.
TEST(ClosedLoop, IsMinimalWhenPlantAndControllerCancel) {
  const std::vector<Zeros> cancelled = {{0.8}, {-0.6}, {{0.5, 0.6}}, {0.8, -0.3}, {{0.2, 0.9}, 0.4}};
  const std::vector<Zeros> extra = {{}, {0.5}, {{0.3, 0.4}}};
  for (const Zeros& modes : cancelled) {
    for (const Zeros& lag : extra) {
      Zeros plant_poles = {1.0, 1.0}, controller_zeros = {0.9};
      plant_poles.insert(plant_poles.end(), lag.begin(), lag.end());
      const Zeros controller_poles = {0.1, {-0.2, 0.1}};
      const ClosedLoop plain =
          close_loop({fraction(0.02, {}, plant_poles), fraction(1.0, controller_zeros, controller_poles)}, 5.0);
      plant_poles.insert(plant_poles.end(), modes.begin(), modes.end());
      controller_zeros.insert(controller_zeros.end(), modes.begin(), modes.end());
      const ClosedLoop loop =
          close_loop({fraction(0.02, {}, plant_poles), fraction(1.0, controller_zeros, controller_poles)}, 5.0);
      EXPECT_EQ(loop.realization.order(), plain.realization.order());
      EXPECT_LT(distance(loop.transfer, plain.transfer), 1e-9);
      const auto hidden = static_cast<Eigen::Index>(loop.hidden_modes.size() - plain.hidden_modes.size());
      EXPECT_EQ(hidden, polynomial_with_zeros(modes).size() - 1);
      for (const std::complex<double>& mode : modes) {
        EXPECT_TRUE(std::any_of(loop.hidden_modes.begin(), loop.hidden_modes.end(),
                                [&](const std::complex<double>& found) { return std::abs(found - mode) < 1e-6; }))
            << mode;
      }
    }
  }
}

TEST(ClosedLoop, HasEveryOrderFromTwoToSix) {
  std::mt19937 generator(4);
  for (int order = 2; order <= 6; ++order) {
    const TransferFunction t = ramp_tracking(random_polynomial(order, generator), 3.0, order > 2 ? 0.01 : 0.0);
    const ClosedLoop loop = closed_loop_from(observable_canonical(t));
    EXPECT_EQ(loop.transfer.denominator().size() - 1, order);
    EXPECT_TRUE(violated_assumptions(loop, 3.0, false).empty()) << order;
  }
}

TEST(ClosedLoop, GivenByItsRealizationIsKeptAsItIs) {
  Eigen::Matrix3d basis;
  basis << 1.0, 0.3, -0.2, 0.5, -1.0, 0.4, 0.1, 0.2, 0.9;
  const ClosedLoop paper = paper_platoon().default_vehicle().loop;
  const StateSpace dense(basis * paper.realization.a() * basis.inverse(), basis * paper.realization.b(),
                         paper.realization.c() * basis.inverse());
  const ClosedLoop loop = closed_loop_from(dense);
  EXPECT_EQ(loop.realization.a(), dense.a());
  EXPECT_EQ(loop.realization.b(), dense.b());
  EXPECT_EQ(loop.realization.c(), dense.c());
  EXPECT_LT(distance(loop.transfer, paper.transfer), 1e-12);
  EXPECT_TRUE(loop.hidden_modes.empty());
  EXPECT_TRUE(violated_assumptions(loop, 3.2, false).empty());
}

TEST(ClosedLoop, GivenByARealizationThatIsNotMinimalHasAMinimalTransferFunction) {
  const StateSpace paper = paper_platoon().default_vehicle().loop.realization;
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(4, 4);
  a.topLeftCorner(3, 3) = paper.a();
  a(3, 3) = 0.3;
  Eigen::VectorXd b = Eigen::VectorXd::Ones(4);
  b.head(3) = paper.b();
  Eigen::RowVectorXd c = Eigen::RowVectorXd::Zero(4);
  c.head(3) = paper.c();
  const ClosedLoop loop = closed_loop_from({a, b, c});
  EXPECT_EQ(loop.realization.order(), 4);
  EXPECT_EQ(loop.transfer.denominator().size() - 1, 3);
  EXPECT_TRUE(violated_assumptions(loop, 3.2, false).empty());
}

TEST(ClosedLoop, ThatIsNotStrictlyProperIsRefused) {
  const TransferFunction plant = fraction(1.0, {}, {1.0, 1.0});
  EXPECT_THROW(close_loop({plant, fraction(0.1, {0.5, 0.4, 0.3}, {0.2})}, 3.2), std::invalid_argument);
  EXPECT_THROW(close_loop({plant, fraction(0.1, {0.5, 0.4, 0.3, 0.1}, {0.2})}, 3.2), std::invalid_argument);
  const ClosedLoop paper = paper_platoon().default_vehicle().loop;
  const ClosedLoop proper{fraction(0.1, {0.5}, {0.2}), paper.realization, {}};
  EXPECT_TRUE(any_contains(violated_assumptions(proper, 3.2, true), "T(z) is not strictly proper"));
}

TEST(ViolatedAssumptions, NameTheMissingDoubleIntegralAction) {
  const TransferFunction controller = fraction(0.05, {0.0}, {-0.89});
  for (const Zeros& poles : {Zeros{1.0, 0.5}, Zeros{0.5, 0.6}, Zeros{{0.9, 0.3}}}) {
    const std::vector<std::string> found =
        violated_assumptions(close_loop({fraction(1.0, {}, poles), controller}, 3.2), 3.2, true);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NE(found[0].find("no double integral action: G(z) K(z) must have two poles at z = 1, that is T(1) = 1 and "
                            "dT/dz(1) = -h for h = 3.2; here T(1) = "),
              std::string::npos);
  }
  // A controller zero at 1 cancels one of the plant's two integrators.
  const ClosedLoop loop = close_loop({fraction(0.1, {}, {1.0, 1.0}), fraction(1.0, {1.0}, {0.2})}, 3.2);
  EXPECT_TRUE(any_contains(violated_assumptions(loop, 3.2, true), "no double integral action"));
}

TEST(ViolatedAssumptions, AreSilentAboutTripleIntegralAction) {
  const ClosedLoop loop = close_loop({fraction(0.02, {}, {1.0, 1.0}), fraction(1.0, {0.97, 0.9}, {1.0, 0.1})}, 5.0);
  EXPECT_TRUE(violated_assumptions(loop, 5.0, false).empty());
}

// A vehicle with drag (time constant 50 s) and engine lag (0.3 s), sampled at 200 Hz, has one integrator
// only.
TEST(ViolatedAssumptions, NameTheMissingDoubleIntegralActionOfAFastSampledVehicle) {
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

TEST(ViolatedAssumptions, AcceptARealizationGivenToSixDigits) {
  const auto rounded = [](double value) { return std::stod(std::to_string(value)); };
  const StateSpace paper = paper_platoon().default_vehicle().loop.realization;
  const StateSpace given(paper.a().unaryExpr(rounded), paper.b().unaryExpr(rounded), paper.c());
  EXPECT_TRUE(violated_assumptions(closed_loop_from(given), 3.2, false).empty());
}

TEST(ViolatedAssumptions, NameTheUnstableLoopUnlessItIsAllowed) {
  const ClosedLoop loop = close_loop({fraction(1.0, {}, {1.0, 1.0}), fraction(3.0, {0.0}, {-0.89})}, 3.2);
  ASSERT_GT(spectral_radius(loop.realization), 1.0);
  const std::vector<std::string> found = violated_assumptions(loop, 3.2, false);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].find("the closed loop is unstable: rho(A) = "), 0u);
  EXPECT_NE(found[0].find("must be < 1 (allow_unstable: true runs it anyway)"), std::string::npos);
  EXPECT_TRUE(violated_assumptions(loop, 3.2, true).empty());
}

TEST(ViolatedAssumptions, NameTheHiddenUnstableModeUnlessItIsAllowed) {
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
  EXPECT_NE(found[0].find("at z = 0.75 +- i 1:"), std::string::npos) << found[0];
}

// The controller's zero at 1 cancels the plant's third integrator; the mode's modulus is 1 up to rounding.
TEST(ViolatedAssumptions, NameTheHiddenModeOnTheUnitCircle) {
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

TEST(ViolatedAssumptions, AreSilentAboutAHiddenStableMode) {
  const ClosedLoop loop =
      close_loop({fraction(0.02, {}, {1.0, 1.0, 0.8}), fraction(1.0, {0.9, 0.8}, {0.1, -0.2})}, 5.0);
  EXPECT_EQ(loop.hidden_modes.size(), 1u);
  EXPECT_TRUE(violated_assumptions(loop, 5.0, false).empty());
}

TEST(ViolatedAssumptions, NameTheMissingEquilibrium) {
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
  EXPECT_NE(found[0].find("here T(1) = 1 and dT/dz(1) = "), std::string::npos) << found[0];
  EXPECT_NE(found[0].find("G(z) K(z) has 1 pole there"), std::string::npos) << found[0];
}

TEST(ViolatedAssumptions, SayWhenTheCoefficientsInDoubleAreNotThoseOfTheLoop) {
  const ClosedLoop loop = close_loop({fraction(1.0, {}, {1.0, 1.0}), fraction(1.35, {0.0}, {-0.89}), true}, 1e15);
  EXPECT_TRUE(any_contains(violated_assumptions(loop, 1e15, false), "too slow for its sample period"));
}

TEST(ClosedLoop, OfAPlantOfZeroIsRefusedAsThat) {
  const TransferFunction zero(Polynomial::Zero(1), Eigen::Vector3d(1.0, -2.0, 1.0));
  try {
    close_loop({zero, fraction(1.0, {0.0}, {-0.89})}, 3.2);
    FAIL() << "was accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("G(z) K(z) = 0"), std::string::npos) << error.what();
  }
}

TEST(ClosedLoop, OfTooHighAnOrderIsRefusedBeforeAnythingIsComputed) {
  const Polynomial high = multiply(Eigen::Vector3d(1.0, -2.0, 1.0), polynomial_with_zeros(Zeros(38, 0.1)));
  EXPECT_THROW(close_loop({TransferFunction{Polynomial::Ones(1), high}, fraction(0.1, {0.9}, {0.1})}, 3.2),
               std::invalid_argument);
  const StateSpace wide(Eigen::MatrixXd::Identity(200, 200) * 0.5, Eigen::VectorXd::Ones(200),
                        Eigen::RowVectorXd::Ones(200));
  EXPECT_THROW(closed_loop_from(wide), std::invalid_argument);
}

// A vehicle sampled at a kilohertz: D(1) is 1e-9 of D's coefficients, which have lost half their digits.
TEST(ClosedLoop, HasAllDigitsOfASlowLoopByPowersOfZMinusOne) {
  const double a = 1.0 - std::ldexp(1.0, -7), gain = std::ldexp(1.0, -28);
  const ClosedLoop loop =
      close_loop({TransferFunction{Eigen::Vector2d(gain, gain), polynomial_with_zeros({1.0, 1.0, a})},
                  TransferFunction{Eigen::Vector2d(1024.0, -1023.75), Eigen::Vector2d(1.0, 0.0)}},
                 1500.0);
  // D = z s^2 (s + 1 - a) + g (2 + s) (1/4 + 1024 s) (1 + 1501 s), by hand.
  const DeltaFraction t = delta_fraction(loop);
  ASSERT_EQ(t.denominator.size(), 6u);
  EXPECT_EQ(t.denominator[0], static_cast<long double>(gain) * 0.5L);
  EXPECT_EQ(t.denominator[1], static_cast<long double>(gain) * (0.25L + 2048.0L + 0.5L * 1501.0L));
  EXPECT_EQ(t.numerator[0], t.denominator[0]);
}

}  // namespace
}  // namespace platoon
