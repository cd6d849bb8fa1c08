#include "stochastic_platoon/math/response/loop_filter.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "unit/math/example_loops.hpp"

namespace platoon {
namespace {

TEST(LoopFilter, HasTheImpulseResponseOfTheRealization) {
  for (const ExampleLoop& example : example_loops()) {
    const StateSpace& loop = example.loop.realization;
    std::vector<double> impulse(40, 0.0);
    impulse[0] = 1.0;
    const std::vector<double> response = LoopFilter(loop)(impulse);
    EXPECT_EQ(response[0], 0.0) << "T is strictly proper";
    Eigen::VectorXd state = loop.b();
    for (std::size_t k = 1; k < response.size(); ++k) {
      const double expected = loop.c() * state;
      EXPECT_NEAR(response[k], expected, 1e-12 * (1.0 + std::abs(expected))) << example.name << " " << k;
      state = (loop.a() * state).eval();
    }
  }
}

TEST(LoopFilter, IsLinearAndTimeInvariant) {
  const LoopFilter filter(paper_loop(3.2).realization);
  const std::vector<double> response = filter({1.0, -2.0, 0.5, 0.0, 3.0, 0.0, 0.0});
  const std::vector<double> later = filter({0.0, 0.0, 2.0, -4.0, 1.0, 0.0, 6.0});
  for (std::size_t k = 0; k + 2 < later.size(); ++k) EXPECT_NEAR(later[k + 2], 2.0 * response[k], 1e-15);
}

TEST(LoopFilter, DecaysFromOneWithoutInput) {
  const StateSpace loop = paper_loop(3.2).realization;
  const std::vector<double> w = LoopFilter(loop).free_response(unit_equilibrium(loop), 5000);
  EXPECT_NEAR(w[0], 1.0, 1e-15);
  EXPECT_EQ(w[4999], 0.0) << "a decayed state is zero, not subnormal";
}

}  // namespace
}  // namespace platoon
