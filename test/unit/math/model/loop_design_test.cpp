#include "stochastic_platoon/math/model/loop_design.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <memory>
#include <stdexcept>
#include <vector>

#include "stochastic_platoon/math/model/closed_loop.hpp"
#include "stochastic_platoon/math/model/exact_transfer.hpp"
#include "stochastic_platoon/math/model/loop_assumptions.hpp"

namespace platoon {
namespace {

using Complex = std::complex<double>;

/// The response of n / d z^-delay to a unit step, at steps 0, 1, ... .
std::vector<double> step_response(const ExactTransfer& transfer, std::size_t count) {
  const ExactPolynomial n = shifted_to_origin(transfer.numerator), d = shifted_to_origin(transfer.denominator);
  const auto lag = static_cast<std::size_t>(transfer.delay) + d.size() - n.size();
  std::vector<Exact> y(count);
  for (std::size_t k = 0; k < count; ++k) {
    for (std::size_t i = 0; i < n.size(); ++i) y[k] += k >= lag + i ? n[i] : Exact(0);
    for (std::size_t i = 1; i < d.size(); ++i) y[k] -= k >= i ? Exact(d[i] * y[k - i]) : Exact(0);
  }
  std::vector<double> rounded;
  for (const Exact& value : y) rounded.push_back(value.convert_to<double>());
  return rounded;
}

Complex value(const ExactPolynomial& p, Complex s) {
  Complex sum = 0.0;
  for (std::size_t j = p.size(); j-- > 0;) sum = sum * s + p[j].convert_to<double>();
  return sum;
}

LoopDesign car(double lag, double delay, double period, bool filter, double kp = 0.2, double ki = 0.0) {
  LoopDesign design{{car_with_actuator_lag(lag, delay), period}, {ControllerGains{kp, 0.7, ki}, period}};
  design.headway_filter = filter;
  return design;
}

// A position after a step of the input is known in closed form.
TEST(Plant, EqualsTheContinuousOneAtTheSamples) {
  constexpr double kPeriod = 0.03;
  for (const double lag : {0.0, 0.1, 0.5}) {
    for (const double delay : {0.0, 0.03, 0.01, 0.2, 0.6, 0.3 * kPeriod}) {
      const Plant plant(car_with_actuator_lag(lag, delay), kPeriod);
      const std::vector<double> found = step_response(plant.exact(), 60);
      for (std::size_t k = 0; k < found.size(); ++k) {
        const double t = static_cast<double>(k) * kPeriod - delay;
        const double expected =
            t <= 0.0 ? 0.0 : t * t / 2.0 - lag * t + (lag > 0.0 ? -lag * lag * std::expm1(-t / lag) : 0.0);
        EXPECT_NEAR(found[k], expected, 1e-15) << lag << " " << delay << " " << k;
      }
      EXPECT_EQ(plant.exact().denominator[0], 0) << "integrators are poles at z = 1 exactly";
      EXPECT_EQ(plant.exact().denominator[1], 0);
      EXPECT_NE(plant.exact().denominator[2], 0);
    }
  }
}

// 0.3 / 0.1 is below 3 in double.
TEST(Plant, HasAWholeDelayForWholeSamples) {
  for (const double delay : {0.3, 0.7, 1.1}) {
    const Plant plant(car_with_actuator_lag(0.2, delay), 0.1);
    EXPECT_EQ(plant.exact().delay, std::lround(10.0 * delay));
    EXPECT_EQ(plant.exact().numerator.size(), 3u);
  }
  EXPECT_EQ(Plant(car_with_actuator_lag(0.2, 0.35), 0.1).exact().delay, 4);
}

TEST(Plant, RejectsInvalidPlants) {
  EXPECT_THROW(Plant(car_with_actuator_lag(0.1, -0.1), 0.1), std::invalid_argument);
  EXPECT_THROW(Plant(car_with_actuator_lag(0.1, 10.1), 0.1), std::invalid_argument);
  EXPECT_THROW(Plant(car_with_actuator_lag(0.1, 0.0), 0.0), std::invalid_argument);
  EXPECT_THROW(Plant(ContinuousPlant{Polynomial::Ones(2), Polynomial::Ones(2)}, 0.1), std::invalid_argument);
}

TEST(Controller, FollowsTheFormulaOfItsGains) {
  constexpr double kPeriod = 0.05;
  for (const ControllerGains& gains : {ControllerGains{0.2, 0.7, 0.0}, ControllerGains{0.2, 0.7, 0.03},
                                       ControllerGains{0.2, 0.0, 0.03}, ControllerGains{0.2, 0.0, 0.0}}) {
    const Controller controller(gains, kPeriod);
    const ExactTransfer& k = controller.exact();
    for (const double w : {0.1, 0.7, 2.0, 3.0}) {
      const Complex z = std::polar(1.0, w), back = 1.0 - 1.0 / z;
      const Complex expected = gains.kp + gains.kd * back / kPeriod + gains.ki * kPeriod / back;
      const Complex found =
          value(k.numerator, z - 1.0) / value(k.denominator, z - 1.0) * std::pow(z, -static_cast<double>(k.delay));
      EXPECT_LT(std::abs(found - expected), 1e-13 * std::abs(expected));
    }
  }
  EXPECT_THROW(Controller(ControllerGains{}, kPeriod), std::invalid_argument);
  EXPECT_EQ(std::get<ControllerGains>(Controller(ControllerGains{0.2, 0.7, 0.1}, 1.0).with_gain(0.4).given()).kd, 1.4);
}

std::vector<ClosedLoop> loops_by_parts() {
  std::vector<ClosedLoop> loops;
  for (const bool filter : {false, true}) {
    for (const double delay : {0.0, 0.01, 0.2, 0.153}) {
      loops.push_back(close_loop(car(0.1, delay, 0.01, filter), 120.0));
      loops.push_back(close_loop(car(0.0, delay, 0.01, filter, 0.2, 0.001), 100.5));
    }
  }
  return loops;
}

// T = z G K / (z + G K ((1 + h) z - h)), or with K over H, from the parts themselves.
TEST(LoopByParts, HasTheTransferFunctionOfItsDesign) {
  for (const bool filter : {false, true}) {
    const LoopDesign design = car(0.1, 0.153, 0.01, filter);
    const ClosedLoop loop = close_loop(design, 120.0);
    for (const double w : {0.01, 0.1, 0.9, 3.0}) {
      const Complex z = std::polar(1.0, w), policy = 121.0 - 120.0 / z;
      const auto at = [&](const ExactTransfer& t) {
        return value(t.numerator, z - 1.0) / value(t.denominator, z - 1.0) * std::pow(z, -static_cast<double>(t.delay));
      };
      const Complex open = at(design.plant.exact()) * at(design.controller.exact()) / (filter ? policy : 1.0);
      const Complex expected = open / (1.0 + open * policy);
      EXPECT_LT(std::abs(loop.transfer(z) - expected), 1e-7 * std::abs(expected)) << w;
      EXPECT_LT(std::abs(resolvent(loop.realization).transfer(z) - expected), 1e-7 * std::abs(expected)) << w;
    }
  }
}

TEST(LoopByParts, EqualsItsRealizationStepByStep) {
  for (const ClosedLoop& loop : loops_by_parts()) {
    ASSERT_TRUE(loop.parts);
    EXPECT_TRUE(violated_assumptions(loop, loop.parts->headway, false).empty());
    const StateSpace& system = loop.realization;
    const std::unique_ptr<LoopBatch> batch = loop_batch(loop);
    batch->start({0.0, 0.0, 0.0}, 0.0);
    Eigen::VectorXd state = Eigen::VectorXd::Zero(system.order());
    std::vector<double> y(3);
    for (int k = 0; k < 300; ++k) {
      const double u = k == 0 ? 1.0 : 0.3 * std::sin(0.2 * k);
      const std::vector<double> input{u + 5.0, 5.0, 5.0 - u};
      batch->step(input.data(), 5.0, y.data(), {});
      state = system.a() * state + system.b() * u;
      const double expected = system.c() * state;
      ASSERT_NEAR(y[0], expected, 1e-12) << k;
      ASSERT_EQ(y[1], 0.0);
      ASSERT_EQ(y[2], -y[0]) << "a batch is three times one realization";
    }
  }
}

// u(k) and y(k) satisfy the equations of LoopParts, realization by realization.
TEST(LoopByParts, FeedsForwardAndReturnsItsInput) {
  constexpr double kGain = 0.7;
  for (const ClosedLoop& loop : loops_by_parts()) {
    const std::unique_ptr<LoopBatch> batch = loop_batch(loop);
    batch->start({0.0, 0.0}, 0.0);
    std::vector<double> state(loop.parts->order(), 0.0), y(2), own(2);
    for (int k = 0; k < 300; ++k) {
      const double position = 0.3 * std::sin(0.2 * k), heard = std::cos(0.1 * k);
      const std::vector<double> positions{0.0, position}, inputs{0.0, heard};
      batch->step(positions.data(), 0.0, y.data(), {inputs.data(), kGain, own.data()});
      const double u = advance(*loop.parts, state, position, kGain * heard);
      ASSERT_EQ(own[1], u) << k;
      ASSERT_EQ(y[1], state.front()) << k;
      ASSERT_EQ(y[0], 0.0);
    }
  }
}

TEST(LoopByParts, AcceleratesByTheFeedForwardAlone) {
  // y = G u, without a headway filter u = K (r - H y) + F v: a step of v alone accelerates by F.
  const ClosedLoop loop = close_loop(car(0.0, 0.0, 0.1, false, 0.0), 30.0);
  const std::unique_ptr<LoopBatch> batch = loop_batch(loop);
  batch->start({0.0}, 0.0);
  const double position = 0.0, heard = 2.0;
  double y = 0.0, own = 0.0;
  batch->step(&position, 0.0, &y, {&heard, 1.5, &own});
  EXPECT_EQ(own, 3.0);
  EXPECT_NEAR(y, 3.0 * 0.1 * 0.1 / 2.0, 1e-15);
}

// The rounding of the coefficients must not move a vehicle at rest, however slow its loop.
TEST(LoopByParts, StaysAtRestToTheBit) {
  for (const ClosedLoop& loop : loops_by_parts()) {
    const std::unique_ptr<LoopBatch> batch = loop_batch(loop);
    batch->start({1234.5, -0.1}, 0.0);
    std::vector<double> y(2);
    const std::vector<double> input{1234.5, -0.1};
    for (int k = 0; k < 1000; ++k) batch->step(input.data(), 0.0, y.data(), {});
    EXPECT_EQ(y, input);
  }
}

// 1700 s at a constant speed of 30 m/s: the position lags by h, to the rounding of the position.
TEST(LoopByParts, FollowsARampAtItsHeadway) {
  const double h = 3000.0;
  const ClosedLoop loop = close_loop(car(0.1, 0.05, 0.001, true), h);
  const std::unique_ptr<LoopBatch> batch = loop_batch(loop);
  batch->start({0.0}, 0.0);
  double y = 0.0, u = 0.0;
  for (int k = 0; k < 1700000; ++k) {
    u = 0.03 * k;
    batch->step(&u, 0.0, &y, {});
  }
  EXPECT_NEAR(u + 0.03 - (y + h * 0.03), 0.0, 1e-6);
}

TEST(LoopByParts, CountsPolesWithoutTheDelay) {
  EXPECT_NO_THROW(close_loop(car(0.1, 0.99, 0.01, true), 300.0));
  Polynomial high = Polynomial::Zero(20);
  high(0) = 1.0;
  high(17) = 0.1;
  const LoopDesign design{{ContinuousPlant{Polynomial::Ones(1), high, 0.2}, 0.01},
                          {ControllerGains{0.2, 0.7, 0.0}, 0.01}};
  EXPECT_THROW(close_loop(design, 100.0), std::invalid_argument);
}

}  // namespace
}  // namespace platoon
