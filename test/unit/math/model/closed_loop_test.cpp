#include "stochastic_platoon/math/model/closed_loop.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include "stochastic_platoon/math/model/loop_assumptions.hpp"
#include "unit/math/model/fractions.hpp"
#include "unit/messages.hpp"
#include "unit/paper_platoon.hpp"
#include "unit/sensitivity.hpp"

namespace platoon {
namespace {

TEST(ClosedLoop, OfThePapersExampleHasOrderThree) {
  for (const double h : {3.2, 2.4, 4.0}) {
    const ClosedLoop loop = paper_loop(h);
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

TEST(ClosedLoop, OfThePapersExampleHasItsSpectralRadii) {
  EXPECT_NEAR(spectral_radius(paper_loop(3.2).realization), 0.5274, 0.00005);
  EXPECT_NEAR(spectral_radius(paper_loop(2.4).realization), 0.6546, 0.00005);
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

TEST(ClosedLoop, HasTheSensitivityOneMinusHT) {
  const ClosedLoop loop = paper_loop(3.2);
  const std::complex<double> z(0.4, 0.9);
  const TransferFunction s = sensitivity(loop.transfer, 3.2);
  EXPECT_LT(std::abs(s(z) - (1.0 - (4.2 - 3.2 / z) * loop.transfer(z))), 1e-14);
  EXPECT_EQ(multiplicity_at_one(s.numerator()), 2);
}

// Factors that cancel between plant and controller change neither T nor its order.
TEST(ClosedLoop, IsMinimalIfPlantAndControllerCancel) {
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

TEST(ClosedLoop, MayHaveAnyOrderFromTwoToSix) {
  std::mt19937 generator(4);
  for (int order = 2; order <= 6; ++order) {
    const TransferFunction t =
        ramp_tracking(random_polynomial(order, generator), 3.0, Polynomial::Constant(1, order > 2 ? 0.01 : 0.0));
    const ClosedLoop loop = closed_loop_from(observable_canonical(t));
    EXPECT_EQ(loop.transfer.denominator().size() - 1, order);
    EXPECT_TRUE(violated_assumptions(loop, 3.0, false).empty()) << order;
  }
}

TEST(ClosedLoop, KeepsAGivenRealization) {
  const StateSpace dense = dense_paper_loop();
  const ClosedLoop loop = closed_loop_from(dense);
  EXPECT_EQ(loop.realization.a(), dense.a());
  EXPECT_EQ(loop.realization.b(), dense.b());
  EXPECT_EQ(loop.realization.c(), dense.c());
  EXPECT_LT(distance(loop.transfer, paper_loop(3.2).transfer), 1e-12);
  EXPECT_TRUE(loop.hidden_modes.empty());
  EXPECT_TRUE(violated_assumptions(loop, 3.2, false).empty());
}

// A turned realization of a loop with C B = C A B = 0.
TEST(ClosedLoop, HasTheRelativeDegreeThatTheDigitsOfItsRealizationDetermine) {
  std::mt19937 generator(8);
  std::normal_distribution<double> draw;
  for (const int order : {3, 4, 6}) {
    const TransferFunction t = ramp_tracking(random_polynomial(order, generator), 3.0);
    const StateSpace canonical = observable_canonical(t);
    const Eigen::MatrixXd turn = Eigen::MatrixXd::NullaryExpr(order, order, [&] { return draw(generator); });
    const Eigen::MatrixXd q = turn.householderQr().householderQ();
    const ClosedLoop loop =
        closed_loop_from({q * canonical.a() * q.transpose(), q * canonical.b(), canonical.c() * q.transpose()});
    EXPECT_EQ(loop.transfer.relative_degree(), order - 1);
    EXPECT_LT(distance(loop.transfer, t), 1e-12);
  }
}

TEST(ClosedLoop, HasAMinimalTransferFunctionForAnyRealization) {
  const StateSpace paper = paper_loop(3.2).realization;
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

TEST(ClosedLoop, IsRejectedUnlessItIsStrictlyProper) {
  const TransferFunction plant = fraction(1.0, {}, {1.0, 1.0});
  EXPECT_THROW(close_loop({plant, fraction(0.1, {0.5, 0.4, 0.3}, {0.2})}, 3.2), std::invalid_argument);
  EXPECT_THROW(close_loop({plant, fraction(0.1, {0.5, 0.4, 0.3, 0.1}, {0.2})}, 3.2), std::invalid_argument);
  const ClosedLoop paper = paper_loop(3.2);
  const ClosedLoop proper{fraction(0.1, {0.5}, {0.2}), paper.realization, {}};
  EXPECT_TRUE(contains(violated_assumptions(proper, 3.2, true).front(), "T(z) is not strictly proper"));
}

TEST(ClosedLoop, IsRejectedForAPlantOfZero) {
  const TransferFunction zero(Polynomial::Zero(1), Eigen::Vector3d(1.0, -2.0, 1.0));
  EXPECT_TRUE(contains(message_of<std::invalid_argument>([&zero] {
                         close_loop({zero, fraction(1.0, {0.0}, {-0.89})}, 3.2);
                       }),
                       "G(z) K(z) = 0"));
}

TEST(ClosedLoop, IsRejectedForTooHighAnOrder) {
  const Polynomial high = multiply(Eigen::Vector3d(1.0, -2.0, 1.0), polynomial_with_zeros(Zeros(38, 0.1)));
  EXPECT_THROW(close_loop({TransferFunction{Polynomial::Ones(1), high}, fraction(0.1, {0.9}, {0.1})}, 3.2),
               std::invalid_argument);
  const StateSpace wide(Eigen::MatrixXd::Identity(200, 200) * 0.5, Eigen::VectorXd::Ones(200),
                        Eigen::RowVectorXd::Ones(200));
  EXPECT_THROW(closed_loop_from(wide), std::invalid_argument);
}

// A vehicle sampled at a kilohertz: D(1) is 1e-9 of D's coefficients, which have lost half their digits.
TEST(ClosedLoop, HasAllDigitsOfASlowLoop) {
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
