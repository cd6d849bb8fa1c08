#include "stochastic_platoon/math/response/loop_response.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "stochastic_platoon/math/numerics/exact.hpp"
#include "unit/math/example_loops.hpp"

namespace platoon {
namespace {

using Sequence = LoopResponse::Sequence;

/// A car sampled at 100 Hz, e^(-s d) / (s^2 (0.5 s + 1)), behind 14 samples of delay.
ClosedLoop delayed_car() {
  Polynomial numerator(3), denominator(17), controller(2), one_step(2);
  numerator << 3.3e-7, 1.3e-6, 3.2e-7;
  denominator.setZero();
  denominator.head(4) << 1.0, -2.980198673306755, 2.96039734661351, -0.980198673306755;
  controller << 40.0, -39.8;
  one_step << 1.0, 0.0;
  return close_loop({TransferFunction{numerator, denominator}, TransferFunction{controller, one_step}}, 150.0);
}

/// y of D y = N u, in a hundred digits by powers of z.
Sequence exact_impulse_response(const ClosedLoop& loop, std::size_t count) {
  ExactFraction t = exact_fraction(loop);
  for (ExactPolynomial* p : {&t.numerator, &t.denominator}) {
    for (std::size_t j = 0; j + 1 < p->size(); ++j) {
      for (std::size_t i = p->size() - 1; i-- > j;) (*p)[i] -= (*p)[i + 1];
    }
  }
  const std::size_t n = t.denominator.size() - 1;
  std::vector<Exact> y;
  Sequence rounded;
  for (std::size_t k = 0; k < count; ++k) {
    Exact value = k <= n && n - k < t.numerator.size() ? t.numerator[n - k] : Exact(0);
    for (std::size_t j = 1; j <= std::min(k, n); ++j) value -= t.denominator[n - j] * y[k - j];
    y.push_back(value);
    rounded.push_back(value.convert_to<long double>());
  }
  return rounded;
}

void expect_equal(const Sequence& found, const Sequence& expected, long double tolerance, const std::string& name) {
  ASSERT_EQ(found.size(), expected.size()) << name;
  long double largest = 0.0L;
  for (const long double value : expected) largest = std::max(largest, std::abs(value));
  for (std::size_t k = 0; k < found.size(); ++k)
    EXPECT_LE(std::abs(found[k] - expected[k]), tolerance * largest) << name << " " << k;
}

TEST(LoopResponse, KeepsTheDigitsOfTheModel) {
  constexpr std::size_t kSteps = 200;
  Sequence impulse(kSteps, 0.0L);
  impulse[0] = 1.0L;
  for (const ExampleLoop& example : example_loops())
    expect_equal(LoopResponse(example.loop)(impulse), exact_impulse_response(example.loop, kSteps), 1e-16L,
                 example.name);
  // 1e-12 by powers of z alone, 1e-14 by powers of z - 1.
  const ClosedLoop car = delayed_car();
  expect_equal(LoopResponse(car)(impulse), exact_impulse_response(car, kSteps), 1e-16L, "car behind a delay");
}

TEST(LoopResponse, HasTheFreeMotionBehindAConstantInput) {
  constexpr std::size_t kSteps = 300;
  for (const ClosedLoop& loop : {paper_loop(3.2), delayed_car()}) {
    const LoopResponse response(loop);
    Sequence step = response(Sequence(kSteps, 1.0L));
    for (long double& value : step) value = 1.0L - value;
    expect_equal(response.free_response(kSteps), step, 1e-15L, "free motion");
  }
}

}  // namespace
}  // namespace platoon
